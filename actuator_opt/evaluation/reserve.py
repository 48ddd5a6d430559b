"""Reserve of a design: limits met without reserve, and the expected yield.

An optimum lies on its limits and meets them at nominal dimensions; many actuators built to it
violate a limit.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

NO_RESERVE = 1e-3
"""Margin below which a met limit has no reserve. A choice: a single tolerance is as wide.
IT7 of a diameter of 20 mm is 21 um, 0.1 % of it (ISO 286-1). Optima end within 1e-6 of a limit."""
NO_ROOM = 1e-6
"""The same for a limit of 0, whose margin is the distance itself in SI: the tolerance of `met`."""
MOST_NAMED = 5
"""Most limits without reserve that a sentence names."""


def without_reserve(margin: float | None, limit: float | None) -> bool:
    """Whether a met limit has a margin below `NO_RESERVE`.

    >>> without_reserve(-1e-9, 4.0), without_reserve(0.02, 4.0), without_reserve(0.0005, 0.0)
    (True, False, False)
    """
    return margin is not None and margin < (NO_RESERVE if limit else NO_ROOM)


def count_words(count: int) -> str:
    """Number of limits without reserve, in words.

    >>> count_words(1), count_words(8)
    ('1 limit without reserve', '8 limits without reserve')
    """
    return f"{count} limit{'' if count == 1 else 's'} without reserve"


@dataclass(frozen=True, slots=True)
class YieldEstimate:
    """Share of the actuators built to a design that meet every requirement.

    Parameters
    ----------
    value, lower, upper : share and its exact 95 % bounds; None if not estimated
    draws : number of independent samples
    with_checks : share that also meets every check; None if the design itself misses a check
    worst, worst_fails : requirement that fails most, and its share of failures
    why : reason for a missing estimate
    """

    value: float | None = None
    lower: float | None = None
    upper: float | None = None
    draws: int = 0
    with_checks: float | None = None
    worst: str | None = None
    worst_fails: float | None = None
    why: str = ""

    def to_dict(self) -> dict[str, Any] | None:
        """The "yield" of the JSON's "reserve"; None if not estimated."""
        if self.value is None:
            return None
        worst = None
        if self.worst is not None:
            worst = {"requirement": self.worst, "fails": self.worst_fails}
        return {
            "value": self.value, "lower": self.lower, "upper": self.upper, "draws": self.draws,
            "with_checks": self.with_checks, "worst": worst,
        }  # fmt: skip

    @property
    def sentence(self) -> str:
        """The estimate, or the reason why it is missing."""
        if self.value is None or self.lower is None or self.upper is None:
            return f"Yield not estimated ({self.why}): `actuator-opt uncertainty` computes it."
        shown = f"{_percent(self.lower)} to {_percent(self.upper)} %, {self.draws} samples"
        said = (
            f"About {_percent(self.value)} % of the actuators built to this design would meet "
            f"every requirement ({shown})"
        )
        if self.with_checks is not None and self.with_checks < self.value:
            said += f", {_percent(self.with_checks)} % every check as well"
        if self.worst is not None and self.worst_fails:
            said += f"; {self.worst} fails most, in {_percent(self.worst_fails)} %"
        return f"{said}."


UNKNOWN = YieldEstimate(why="an evaluation does not sample")
"""Yield of a plain evaluation."""


def sentences(names: Sequence[str], estimate: YieldEstimate, *, movable: bool) -> tuple[str, ...]:
    """Limits without reserve by name, the yield, and remedies.

    Parameters
    ----------
    names : limits without reserve
    estimate : the yield
    movable : whether the design has variables, so that `optimise` can add reserves
    """
    said = []
    if names:
        more = f" and {len(names) - MOST_NAMED} more" if len(names) > MOST_NAMED else ""
        named = ", ".join(names[:MOST_NAMED])
        said.append(f"Without reserve (margin below {100 * NO_RESERVE:g} %): {named}{more}.")
    said.append(estimate.sentence)
    known = estimate.value is not None
    if movable and (names or (known and estimate.value != 1)):
        said.append("`actuator-opt optimise --yield 0.99` adds a reserve to every limit.")
    elif known and estimate.value != 1:
        said.append("`actuator-opt uncertainty` shows the causes of scatter.")
    return tuple(said)


def _percent(share: float) -> str:
    """A share in per cent, with a decimal near 0 and 100.

    >>> _percent(0.026), _percent(0.436), _percent(0.9967), _percent(1.0), _percent(0.0)
    ('2.6', '44', '99.7', '100', '0')
    """
    percent = 100 * share
    near = 0 < percent < 10 or 90 < percent < 100
    return f"{percent:.1f}" if near else f"{percent:.0f}"
