"""Results of a session: predictions, prices, bare optima, and curves of optima."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import asdict, field
from typing import TYPE_CHECKING, Any

import numpy as np

from ..base.dataclass import dataclass
from ..base.quantities import Quantity
from ..base.tables import OneLine, aligned
from ..evaluation import PreparedDesign
from ..evaluation.limits import LimitRow

if TYPE_CHECKING:
    from ..rendering.tables import DataTable


@dataclass(frozen=True, slots=True)
class Prediction:
    """An optimum predicted by linear extrapolation from the session's optimum, in SI.

    The prediction for a change d of the numbers p is f(p + d) = f(p) + s(d) and x(p + d) = x(p) + J
    d. Here f is the objective, s its first-order change, x the free dimensions, and J their
    derivative with respect to p. J solves the linearised optimality conditions [Fiacco1983].

    Parameters
    ----------
    objective : predicted objective; infinite (the worst value) if even the smallest change leaves
        no feasible design
    variables : predicted free dimensions by PATH
    valid : whether, to first order, the same limits stay active during the whole change
    why : if not valid, which limit first becomes active or inactive, and after what share of the
        change
    """

    objective: float
    variables: Mapping[str, float]
    valid: bool
    why: str = ""

    def to_dict(self) -> dict[str, Any]:
        """As plain data, SI."""
        return asdict(self)


@dataclass(frozen=True, slots=True)
class Price:
    """Price of a number at the session's optimum: change of the objective per unit, both in SI.

    Parameters
    ----------
    path, value : PATH of the number, and its value
    slope_down, slope_up : derivative of the objective by the number, for a decrease and for an
        increase of the number. The two differ only at a degenerate vertex, where the multipliers
        are not unique. None if even the smallest change in this direction leaves no feasible design
    holds : lowest and highest value between which, to first order, the same limits stay active;
        None on a side where they stay active up to a change of 100 %
    changes : which limit becomes active or inactive at each of the two values in `holds`
    movement : change of each free dimension per unit of the number, by PATH
    """

    path: str
    value: float
    slope_down: float | None
    slope_up: float | None
    holds: tuple[float | None, float | None]
    changes: tuple[str | None, str | None]
    movement: Mapping[str, float] = field(default_factory=dict)

    def to_dict(self) -> dict[str, Any]:
        """As plain data, SI."""
        return asdict(self)


@dataclass(frozen=True, slots=True)
class BareOptimum:
    """An optimum whose design is not evaluated, in SI; see `Session.bare_optimum`.

    Parameters
    ----------
    objective : value of the objective
    variables : the free dimensions by PATH
    active : labels of the active limits and bounds
    residual : residual of the optimality conditions, at most 1e-6
    subject, limits : the prepared design at the optimum, and its active limits
    """

    objective: float
    variables: Mapping[str, float]
    active: tuple[str, ...]
    residual: float
    subject: PreparedDesign = field(repr=False, compare=False)
    limits: tuple[LimitRow, ...] = field(repr=False, compare=False)

    def to_dict(self) -> dict[str, Any]:
        """As plain data, SI."""
        return {
            "objective": self.objective,
            "variables": dict(self.variables),
            "active": list(self.active),
            "residual": self.residual,
        }


@dataclass(frozen=True, slots=True)
class OptimumCurve(OneLine):
    """Optima for a series of values of one number, in SI.

    Parameters
    ----------
    path, quantity : PATH of the number, and its physical quantity
    values : its values, in the requested order
    objectives : objective of each optimum; None if there is no feasible design
    variables : the free dimensions of each optimum by PATH; empty if there is no design
    objective : physical quantity of the objective; None for a weighted sum
    quantities : physical quantity of each free dimension by PATH
    """

    path: str
    quantity: Quantity
    values: tuple[float, ...]
    objectives: tuple[float | None, ...]
    variables: tuple[Mapping[str, float], ...]
    objective: Quantity | None = None
    quantities: Mapping[str, Quantity] = field(default_factory=dict)

    def __len__(self) -> int:
        """Number of values."""
        return len(self.values)

    @property
    def in_short(self) -> tuple[str, str]:
        """The number of values that have a design."""
        return self.path, f"{sum(self.found)} of {len(self)} values have a design"

    @property
    def found(self) -> tuple[bool, ...]:
        """For each value, whether it has a feasible design."""
        return tuple(objective is not None for objective in self.objectives)

    def columns(self) -> dict[str, list[float]]:
        """Value, objective and free dimensions as columns in SI; NaN where there is no design."""
        names = dict.fromkeys(name for row in self.variables for name in row)
        result = {
            self.path: list(self.values),
            "objective": [
                math.nan if objective is None else objective for objective in self.objectives
            ],
        }
        return result | {
            name: [row.get(name, math.nan) for row in self.variables] for name in names
        }

    def table(self) -> DataTable:
        """The `columns` as a table with units, for arrays, CSV and data frames."""
        from ..rendering.tables import DataColumn, DataTable

        known = {**self.quantities, self.path: self.quantity, "objective": self.objective}
        return DataTable(
            self.path,
            [
                DataColumn(name, np.array(values, dtype=float), known.get(name))
                for name, values in self.columns().items()
            ],
        )

    def to_dict(self) -> dict[str, Any]:
        """As plain data, SI."""
        return {
            "path": self.path,
            "values": list(self.values),
            "objectives": list(self.objectives),
            "variables": [dict(row) for row in self.variables],
        }

    def __str__(self) -> str:
        """The values and their objectives as a table with units."""
        rows = [[self.path, "objective"]]
        for value, objective in zip(self.values, self.objectives, strict=True):
            if objective is None:
                text = "none found"
            elif self.objective is None:
                text = f"{objective:.6g}"
            else:
                text = self.objective.text(objective, 6)
            rows.append([self.quantity.text(value, 6), text])
        return aligned(rows, right=(0, 1))
