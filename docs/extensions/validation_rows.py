"""Published values, statements and second programs: what a row of the page of validation is."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

Number = float | tuple[float, float]


@dataclass(frozen=True)
class Case:
    """A published number or range, beside ours.

    Parameters
    ----------
    subject : the quantity, in words
    source : where it is published, in Markdown
    published : the number, or the ends of a range, in `unit`
    ours : function of the computed value, or the value that the test asserts
    tests : name of the test that guards it
    unit : unit of both values
    within : largest relative deviation that counts as reproduced
    why : reason for a larger deviation; empty if there is none
    solved : input that was solved from, or copied from, the published value; empty if there is
        none. Such a row shows which input would explain the value; it confirms nothing
    agreement : whether the value is the share of a foreign run that ours agrees with, 1 at best,
        which nobody published
    """

    subject: str
    source: str
    published: Number
    ours: Callable[[], float] | float
    tests: str
    unit: str = ""
    within: float = 0.005
    why: str = ""
    solved: str = ""
    agreement: bool = False

    def value(self) -> float:
        """The computed value."""
        return float(self.ours() if callable(self.ours) else self.ours)

    def deviation(self) -> float:
        """Relative deviation of the computed value; 0 within a published range."""
        value = self.value()
        ends = self.published if isinstance(self.published, tuple) else (self.published,)
        if len(ends) == 2 and ends[0] <= value <= ends[1]:
            return 0.0
        nearest = min(ends, key=lambda end: abs(value - end))
        return (value - nearest) / abs(nearest)

    def reproduced(self) -> bool:
        """Whether both values agree."""
        return abs(self.deviation()) <= self.within


@dataclass(frozen=True)
class Claim:
    """A published statement without a number, and whether our models confirm it."""

    subject: str
    source: str
    ours: str
    tests: str
    holds: bool


@dataclass(frozen=True)
class Agreement:
    """Largest difference to a second program, as the test asserts it."""

    subject: str
    program: str
    within: str
    tests: str
