"""Results of a robust optimisation: limits met with a stated probability."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any


@dataclass(frozen=True, slots=True)
class Round:
    """One optimum of the sequence: objective (SI) and share of draws that meet all limits."""

    objective: float
    rate: float


@dataclass(frozen=True, slots=True)
class Robust:
    """Robustness of an optimum with uncertain inputs.

    Parameters
    ----------
    target : requested probability
    rate, lower, upper : of meeting all covered limits, in an independent sample; 95 % bounds
    samples : draws of that sample
    converged : whether the reserves converged
    nominal_objective, nominal_rate : of the optimum without reserves
    reserves : extra margin a robust search requires, by limit
    rounds : the sequence of optima, the one without reserves first
    left_out : limits not covered: checks that the optimum misses anyway
    sentence : the result in words
    """

    target: float
    rate: float
    lower: float
    upper: float
    samples: int
    converged: bool
    nominal_objective: float
    nominal_rate: float
    reserves: Mapping[str, float]
    rounds: tuple[Round, ...]
    left_out: tuple[str, ...]
    sentence: str

    @property
    def reached(self) -> bool:
        """Whether the independent sample reaches the requested probability."""
        return self.rate >= self.target

    def to_dict(self) -> dict[str, Any]:
        """The JSON form (SI)."""
        found = asdict(self)
        for key in ("rate", "lower", "upper"):
            del found[key]
        bounds = {"value": self.rate, "lower": self.lower, "upper": self.upper}
        return found | {"yield": bounds, "left_out": list(self.left_out)}
