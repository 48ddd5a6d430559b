"""What a robust optimum is, as data: limits met at a stated probability."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any


@dataclass(frozen=True, slots=True)
class Round:
    """One ordinary optimum on the way: objective (SI) and the share of draws that meet all."""

    objective: float
    rate: float


@dataclass(frozen=True, slots=True)
class Robust:
    """How an optimum keeps its limits while its numbers scatter.

    Parameters
    ----------
    target : probability asked for
    rate, lower, upper : of an independent sample: all limits covered hold; 95 % bounds
    samples : draws of that sample
    converged : whether the reserves came to rest
    nominal_objective, nominal_rate : of the optimum without reserves
    reserves : margin kept beyond each limit, by its name
    rounds : optima on the way, the one without reserves first
    left_out : limits that are not covered: checks that the optimum misses anyway
    sentence : all of it in words
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
        """Whether as many of the independent sample hold as were asked for."""
        return self.rate >= self.target

    def to_dict(self) -> dict[str, Any]:
        """The JSON form (SI)."""
        found = asdict(self)
        for key in ("rate", "lower", "upper"):
            del found[key]
        bounds = {"value": self.rate, "lower": self.lower, "upper": self.upper}
        return found | {"yield": bounds, "left_out": list(self.left_out)}
