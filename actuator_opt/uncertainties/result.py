"""Results of an uncertainty study."""

from __future__ import annotations

from math import isfinite
from typing import Any

import numpy as np

from ..base.dataclass import dataclass
from ..base.tables import Displayed, aligned
from ..optimisation.problem import Vector
from .estimate import Rate
from .inputs import Input


@dataclass(frozen=True, slots=True)
class LimitYield:
    """Probability of meeting one limit.

    Parameters
    ----------
    name, metric, sense, limit : name, metric, sense and value (SI) of the limit
    required : whether the limit is a requirement; otherwise it belongs to the check list
    margin : margin of the nominal design; None without a value
    rate : probability of meeting the limit
    margins : margins at the 1, 5, 50, 95 and 99 % quantiles of the draws; None without a value
    """

    name: str
    metric: str
    sense: str
    limit: float
    required: bool
    margin: float | None
    rate: Rate
    margins: tuple[float | None, ...]

    def to_dict(self) -> dict[str, Any]:
        """Return the JSON form."""
        names = ("p1", "p5", "p50", "p95", "p99")
        return {
            "name": self.name, "metric": self.metric, "sense": self.sense, "limit": self.limit,
            "required": self.required, "margin": self.margin, "yield": self.rate.to_dict(),
            "margins": dict(zip(names, self.margins, strict=True)),
        }  # fmt: skip


@dataclass(frozen=True, slots=True)
class Index:
    """Share of an output's variance due to an input: alone (first), with interactions (total).

    `first_half` and `total_half` are half the widths of the 95 % confidence intervals. All are None
    if the output is constant.
    """

    path: str
    output: str
    first: float | None
    total: float | None
    first_half: float | None
    total_half: float | None

    def to_dict(self) -> dict[str, Any]:
        """Return the JSON form."""

        def bounds(value: float | None, half: float | None) -> dict[str, float] | None:
            if value is None or half is None:
                return None
            return {"value": value, "lower": value - half, "upper": value + half}

        return {
            "parameter": self.path,
            "output": self.output,
            "first": bounds(self.first, self.first_half),
            "total": bounds(self.total, self.total_half),
        }


@dataclass(frozen=True, slots=True)
class Swing:
    """Values of an output with one input at its 5 % and 95 % quantile, and all others nominal."""

    path: str
    output: str
    at_5: float | None
    at_95: float | None

    @property
    def size(self) -> float:
        """Return the difference between both values; infinite if either is missing."""
        if self.at_5 is None or self.at_95 is None:
            return float("inf")
        return abs(self.at_95 - self.at_5)

    def to_dict(self) -> dict[str, Any]:
        """Return the JSON form."""
        return {
            "parameter": self.path, "output": self.output, "p5": self.at_5, "p95": self.at_95,
        }  # fmt: skip


@dataclass(frozen=True, slots=True)
class StoredDraws:
    """Input values (d, n) and limit margins (m, n) of the stored draws."""

    values: Vector
    margins: Vector


LEAST = "least margin"
"""Name of the output that is the least margin of all requirements."""


@dataclass(frozen=True)
class Uncertainty(Displayed):
    """Yield, sensitivity indices and tornado of a design with uncertain inputs.

    Parameters
    ----------
    name, version, spec_hash : name and hash of the design, and version of the program
    inputs : uncertain inputs
    count, method, seed : number, method and seed of the draws
    rate : probability of meeting all requirements
    rate_checks : probability of meeting all requirements and the built-in checks
    limits : results for each requirement, then each check
    nominal : outputs of the nominal design, by name; the margin of a limit has the name of the
        limit
    units : SI units of the metrics among the outputs, by name
    indices, swings : sensitivity indices and tornado entries, by input and output
    index_rows, dropped : size of the sample for the indices, and share of it without a value
    kept : draws that are stored for tables and figures
    notes : notes on what the yield covers
    """

    name: str
    version: str
    spec_hash: str
    inputs: tuple[Input, ...]
    count: int
    method: str
    seed: int
    rate: Rate
    rate_checks: Rate
    limits: tuple[LimitYield, ...]
    nominal: dict[str, float | None]
    units: dict[str, str]
    indices: tuple[Index, ...]
    swings: tuple[Swing, ...]
    index_rows: int
    dropped: float
    kept: StoredDraws
    notes: tuple[str, ...]
    seconds: float

    @property
    def in_short(self) -> tuple[str, str]:
        """The yield, and the number of draws."""
        rate = self.rate
        bounds = f"{100 * rate.lower:.2f} to {100 * rate.upper:.2f} %"
        return self.name, f"yield {100 * rate.value:.2f} % ({bounds}), {self.count} draws"

    @property
    def required(self) -> tuple[LimitYield, ...]:
        """Return the requirements, the most likely to fail first."""
        return tuple(sorted((x for x in self.limits if x.required), key=_worst))

    @property
    def checks(self) -> tuple[LimitYield, ...]:
        """Return the check list, the most likely to fail first."""
        return tuple(sorted((x for x in self.limits if not x.required), key=_worst))

    @property
    def met(self) -> bool:
        """Whether the nominal design meets every requirement."""
        return all(x.margin is not None and x.margin >= -1e-6 for x in self.required)

    def of_output(self, output: str) -> tuple[list[Index], list[Swing]]:
        """Return indices and tornado entries of one output, the largest first."""
        indices = [index for index in self.indices if index.output == output]
        swings = [swing for swing in self.swings if swing.output == output]
        indices.sort(key=lambda index: (-(index.total or 0.0), index.path))
        swings.sort(key=lambda swing: (-swing.size, swing.path))
        return indices, swings

    def to_dict(self) -> dict[str, Any]:
        """Return the `uncertainty --json` object (SI)."""
        return {
            "name": self.name,
            "version": self.version,
            "spec_hash": self.spec_hash,
            "yield": self.rate.to_dict(),
            "yield_with_checks": self.rate_checks.to_dict(),
            "samples": self.count,
            "method": self.method,
            "seed": self.seed,
            "inputs": [entry.to_dict() for entry in self.inputs],
            "requirements": [limit.to_dict() for limit in self.required],
            "checks": [check.to_dict() for check in self.checks],
            "outputs": {
                name: {"value": value, "unit": self.units.get(name, "")}
                for name, value in self.nominal.items()
            },
            "indices": [index.to_dict() for index in self.indices],
            "index_rows": self.index_rows,
            "dropped": self.dropped,
            "tornado": [swing.to_dict() for swing in self.swings],
            "notes": list(self.notes),
            "seconds": self.seconds,
        }

    def __str__(self) -> str:
        """Return yield and requirements as a table."""
        rows = [["requirement", "margin", "holds", "lower", "upper"]]
        for limit in self.required:
            margin = "-" if limit.margin is None else f"{100 * limit.margin:.2f} %"
            bounds = (limit.rate.value, limit.rate.lower, limit.rate.upper)
            rows.append([limit.name, margin, *(f"{100 * x:.2f} %" for x in bounds)])
        rate = self.rate
        headline = (
            f"yield {100 * rate.value:.2f} % (95 % bounds: {100 * rate.lower:.2f} to "
            f"{100 * rate.upper:.2f} %) from {self.count} draws"
        )
        return "\n".join([headline, "", aligned(rows, right=(1, 2, 3, 4))])


def _worst(limit_yield: LimitYield) -> tuple[float, float, str]:
    low = limit_yield.margins[0]
    return limit_yield.rate.value, -np.inf if low is None else low, limit_yield.name


def number(value: float) -> float | None:
    """Return a float, or None for a value that is not finite."""
    return float(value) if isfinite(value) else None
