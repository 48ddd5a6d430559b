"""Prices of requirements and parameters, and the most valuable changes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field
from typing import Any, Literal, TypeAlias

CHANGE = 0.1
"""Relative change at which every row is predicted and re-solved (contract)."""

STRAIGHT = 0.25
"""Largest error of the straight line, as a share of the re-solved change, to call it straight."""

Kind: TypeAlias = Literal["requirement", "parameter", "material"]
"""A limit to negotiate, a fixed number of the design, or a material property."""


@dataclass(frozen=True, slots=True)
class Sensitivity:
    """The price of one requirement limit or one parameter, in SI of the objective per SI of it.

    Parameters
    ----------
    parameter : its PATH
    label : of its quantity
    unit : display unit
    scale : display value = SI value / scale
    limit : present value
    price : change of the objective per unit of it
    percent_per_percent : relative change of the objective per relative change of it; None if one of
        the two is 0
    predicted_10, resolved_10, predicted_minus10, resolved_minus10 : the objective at ±10 % by the
        price, and re-optimised; None without a design
    holds_until : where the active set changes; None beyond ±100 %
    next_active : what changes there
    active : whether the limit is active at the optimum
    price_up, price_down : prices of raising and of lowering it, which differ only at a degenerate
        vertex; None if the next step that way leaves no design
    movement : change of each variable of the optimum per unit of it, by PATH
    """

    parameter: str
    label: str
    unit: str
    scale: float
    limit: float
    price: float
    percent_per_percent: float | None
    predicted_10: float | None
    resolved_10: float | None
    predicted_minus10: float | None
    resolved_minus10: float | None
    holds_until: float | None
    next_active: str | None
    active: bool
    price_up: float | None
    price_down: float | None
    movement: Mapping[str, float] = field(default_factory=dict)

    @property
    def kind(self) -> Kind:
        """Whether it is a limit to negotiate, a number of the design, or a material property."""
        root = self.parameter.partition(".")[0].partition("[")[0]
        if root in ("requirements", "load_cases"):
            return "requirement"
        return "material" if root == "materials" else "parameter"

    @property
    def ends(self) -> tuple[tuple[int, float | None, float | None], ...]:
        """Sign, predicted and re-solved objective of both ends; none for a limit of 0."""
        if self.limit == 0:
            return ()
        return (
            (1, self.predicted_10, self.resolved_10),
            (-1, self.predicted_minus10, self.resolved_minus10),
        )

    @property
    def one_sided(self) -> bool:
        """Whether raising and lowering it have different prices."""
        up, down = self.price_up, self.price_down
        if up is None or down is None:
            return up is not down
        return abs(up - down) > 1e-6 * max(abs(up), abs(down))

    def effect(self, objective: float) -> float:
        """Largest re-solved change of the objective within ±10 %."""
        found = [abs(solved - objective) for _, _, solved in self.ends if solved is not None]
        return max(found, default=0.0)

    def straight(self, objective: float) -> bool:
        """Whether the price predicts both ends to a quarter of their change."""
        for _, predicted, solved in self.ends:
            if predicted is None or solved is None:
                if predicted is not solved:
                    return False
                continue
            larger = max(abs(solved - objective), abs(predicted - objective))
            if abs(predicted - solved) > STRAIGHT * larger + 1e-9 * abs(objective):
                return False
        return True

    def to_dict(self, objective: float) -> dict[str, Any]:
        """The row in JSON (SI)."""
        shown = asdict(self)
        for name in ("label", "unit", "scale"):
            del shown[name]
        return shown | {"kind": self.kind, "straight": self.straight(objective)}


def ranked(rows: Sequence[Sensitivity], objective: float) -> tuple[Sensitivity, ...]:
    """Rows by re-solved effect, the largest first."""
    return tuple(
        sorted(rows, key=lambda r: (-r.effect(objective), -abs(r.percent_per_percent or 0.0)))
    )


@dataclass(frozen=True, slots=True)
class Offer:
    """The better end of a row: gain of a ±10 % change (SI, `gain` > 0 is better)."""

    row: Sensitivity
    change: float
    value: float
    objective: float
    gain: float

    def to_dict(self) -> dict[str, Any]:
        """The offer in JSON (SI)."""
        kept = {name: getattr(self, name) for name in ("change", "value", "objective", "gain")}
        return {"parameter": self.row.parameter} | kept


@dataclass(frozen=True, slots=True)
class Offers:
    """The most valuable changes: the best offer of each kind, None without one.

    `no_design` are the requirements that cannot be tightened by 10 %: rows with the sign of the
    infeasible change.
    """

    requirement: Offer | None
    parameter: Offer | None
    material: Offer | None
    no_design: tuple[tuple[Sensitivity, int], ...]

    @property
    def found(self) -> tuple[Offer, ...]:
        """The existing offers, requirements first."""
        both = (self.requirement, self.parameter, self.material)
        return tuple(one for one in both if one is not None)

    def to_dict(self) -> dict[str, Any]:
        """The "what_buys_most" of `optimise --json` (SI); its sentence is the optimisation's."""
        kinds = ("requirement", "parameter", "material")
        found = {name: getattr(self, name) for name in kinds}
        return {name: None if one is None else one.to_dict() for name, one in found.items()} | {
            "no_design": [
                {"parameter": row.parameter, "change": sign * CHANGE}
                for row, sign in self.no_design
            ]
        }


def offers(rows: Sequence[Sensitivity], objective: float, *, maximised: bool) -> Offers:
    """The best re-solved end of each kind of row, if better than the optimum."""
    wish = 1.0 if maximised else -1.0
    best: dict[Kind, Offer] = {}
    lost = []
    for row in rows:
        for sign, _, solved in row.ends:
            if solved is None:
                if row.kind == "requirement":
                    lost.append((row, sign))
                continue
            gain = wish * (solved - objective)
            rival = best.get(row.kind)
            if gain > 1e-6 * abs(objective) and (rival is None or gain > rival.gain):
                value = row.limit * (1 + sign * CHANGE)
                best[row.kind] = Offer(row, sign * CHANGE, value, solved, gain)
    return Offers(best.get("requirement"), best.get("parameter"), best.get("material"), tuple(lost))
