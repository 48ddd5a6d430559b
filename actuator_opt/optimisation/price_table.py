"""Table of prices of a design's optimum: limits and parameters with the largest effect.

A row is a `Sensitivity`. The best changes by 10 % of each kind of parameter are its `Offers`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, field, replace
from typing import Any, Literal, TypeAlias

import numpy as np

from ..base.dataclass import dataclass
from ..base.numeric import STEP
from ..base.quantities import Quantity, short
from ..base.units import unit
from ..evaluation.influences import NO_PERCENT, input_quantity
from ..evaluation.kernel import FEW_SAMPLES, with_few_samples
from .actuator import ActuatorProblem, build
from .prices import finite, prices
from .solution import Outcome, Solution
from .solver import solve

CHANGE = 0.1
"""Relative change of a parameter for which the price's prediction is checked by re-solving."""
STRAIGHT = 0.25
"""Largest error, as a share of the re-solved change, with which a straight-line prediction counts
as good."""
Kind: TypeAlias = Literal["requirement", "parameter", "material"]
"""A limit that can be negotiated, a fixed number of the design, or a material property."""


@dataclass(frozen=True, slots=True)
class Sensitivity:
    """The price of one limit or parameter, in SI units of objective and parameter.

    Parameters
    ----------
    parameter : PATH
    label : name of the parameter's quantity
    unit : display unit of the parameter
    scale : display value = SI value / scale
    limit : present value
    price : change of the objective per unit of the parameter
    percent_per_percent : relative change of the objective per relative change of the parameter;
        None if the objective or the parameter is 0
    predicted_10, resolved_10, predicted_minus10, resolved_minus10 : the objective with the
        parameter changed by +10 % and -10 %, predicted from the price or re-optimised; None if no
        design exists
    holds_until : value of the parameter up to which the same limits are active; None if it is more
        than ±100 % away
    next_active : the limit that becomes active, or stops being active, at the value `holds_until`
    active : whether the limit is active at the optimum
    price_up, price_down : prices of an increase and of a decrease, which differ only at a
        degenerate vertex; None if no design exists in this direction
    movement : change of each variable at the optimum per unit of the parameter, by PATH
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
        """Whether the parameter is a limit, a number of the design, or a material property."""
        root = self.parameter.partition(".")[0].partition("[")[0]
        if root in ("requirements", "load_cases", "duty"):
            return "requirement"
        return "material" if root == "materials" else "parameter"

    @property
    def ends(self) -> tuple[tuple[int, float | None, float | None], ...]:
        """For +10 % and -10 %: sign, predicted objective, re-solved objective.

        Empty for a limit of 0.
        """
        if self.limit == 0:
            return ()
        return (
            (1, self.predicted_10, self.resolved_10),
            (-1, self.predicted_minus10, self.resolved_minus10),
        )

    @property
    def one_sided(self) -> bool:
        """Whether an increase and a decrease have different prices."""
        up, down = self.price_up, self.price_down
        if up is None or down is None:
            return up is not down
        return abs(up - down) > 1e-6 * max(abs(up), abs(down))

    def effect(self, objective: float) -> float:
        """Largest re-solved change of the objective if the parameter changes by +10 % or -10 %."""
        changes = [abs(solved - objective) for _, _, solved in self.ends if solved is not None]
        return max(changes, default=0.0)

    def straight(self, objective: float) -> bool:
        """Whether the price predicts the changes of the objective at ±10 % to within a quarter."""
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
        result = asdict(self)
        for name in ("label", "unit", "scale"):
            del result[name]
        return result | {"kind": self.kind, "straight": self.straight(objective)}


def ranked(rows: Sequence[Sensitivity], objective: float) -> tuple[Sensitivity, ...]:
    """Rows sorted by their re-solved effect on the objective, the largest first."""
    return tuple(
        sorted(rows, key=lambda r: (-r.effect(objective), -abs(r.percent_per_percent or 0.0)))
    )


@dataclass(frozen=True, slots=True)
class Offer:
    """Change of one parameter by 10 %, up or down, that improves the objective by `gain` (SI)."""

    row: Sensitivity
    change: float
    value: float
    objective: float
    gain: float

    def to_dict(self) -> dict[str, Any]:
        """The offer in JSON (SI)."""
        values = {name: getattr(self, name) for name in ("change", "value", "objective", "gain")}
        return {"parameter": self.row.parameter} | values


@dataclass(frozen=True, slots=True)
class Offers:
    """The most valuable change by 10 % of each kind of parameter; None if no change is worthwhile.

    `no_design` lists the requirements which, changed by 10 %, leave no feasible design, with the
    sign of that change.
    """

    requirement: Offer | None
    parameter: Offer | None
    material: Offer | None
    no_design: tuple[tuple[Sensitivity, int], ...]

    @property
    def found(self) -> tuple[Offer, ...]:
        """The changes that are not None, requirements first."""
        existing = (self.requirement, self.parameter, self.material)
        return tuple(offer for offer in existing if offer is not None)

    def to_dict(self) -> dict[str, Any]:
        """The "what_buys_most" of `optimise --json` (SI), except for its sentence."""
        kinds = ("requirement", "parameter", "material")
        best_offers = {name: getattr(self, name) for name in kinds}
        return {
            name: None if offer is None else offer.to_dict() for name, offer in best_offers.items()
        } | {
            "no_design": [
                {"parameter": row.parameter, "change": sign * CHANGE}
                for row, sign in self.no_design
            ]
        }


def offers(rows: Sequence[Sensitivity], objective: float, *, maximised: bool) -> Offers:
    """For each kind of parameter, the best re-solved change by 10 %, if it improves the optimum."""
    direction = 1.0 if maximised else -1.0
    best: dict[Kind, Offer] = {}
    infeasible = []
    for row in rows:
        for sign, _, solved in row.ends:
            if solved is None:
                if row.kind == "requirement":
                    infeasible.append((row, sign))
                continue
            gain = direction * (solved - objective)
            rival = best.get(row.kind)
            if gain > 1e-6 * abs(objective) and (rival is None or gain > rival.gain):
                value = row.limit * (1 + sign * CHANGE)
                best[row.kind] = Offer(row, sign * CHANGE, value, solved, gain)
    return Offers(
        best.get("requirement"), best.get("parameter"), best.get("material"), tuple(infeasible)
    )


MOST_PARAMETERS = 10
"""Maximum number of parameters (besides limits) in the sensitivity table, the most important first.
"""
LEAST_EFFECT = 1e-3
"""A parameter enters the table if its change by 1 % changes the objective by at least this many
per cent."""
CLOSE = 1e-3
"""Largest difference between the optima with few and with all samples of long duty cycles, as a
share of the objective, with which prices count few samples (our choice)."""

FREE = 1e-9
"""A limit whose value is 0 is left out if its price, relative to the objective, is at most this."""


def priced(
    actuator: ActuatorProblem, solution: Solution
) -> tuple[tuple[Sensitivity, ...], tuple[str, ...]]:
    """Prices as `sensitivities`, and a sentence if they count few samples of long duty cycles.

    They are then those of the optimum with few samples. If a search from the optimum with all
    samples ends elsewhere, all samples count.
    """
    subject = with_few_samples(actuator.subject)
    if subject is not actuator.subject:
        few = build(subject)
        starts = [optimum.x for optimum in solution.optima]
        problem = replace(few.problem, start=solution.x)
        near = solve(problem, starts=1 + len(starts), samples=0, more_starts=starts)
        added = solution.objective - near.objective
        if near.outcome is Outcome.OPTIMUM and abs(added) <= CLOSE * abs(solution.objective):
            note = (
                f"prices count {FEW_SAMPLES} samples of each duty cycle; all other results count "
                "all samples"
            )
            return sensitivities(few, near, added=added), (note,)
    return sensitivities(actuator, solution), ()


def sensitivities(
    actuator: ActuatorProblem, solution: Solution, *, added: float = 0.0
) -> tuple[Sensitivity, ...]:
    """Prices of the limits, and of the parameters with the largest effect on the objective.

    To predicted and re-optimised objectives, `added` is added.
    """
    active = _active_limits(actuator, solution)
    limits = dict.fromkeys(
        row.limit_of.path
        for row in actuator.rows
        if row.limit_of.path is not None
        and (row.limit_of.origin in ("requirement", "case") or row.limit_of.path in active)
    )
    paths = (*limits, *_strongest(actuator, solution, set(limits)))
    numbers = actuator.subject.numbers
    paths = tuple(path for path in paths if path in numbers and (numbers[path] or path in active))
    parameter_prices = prices(actuator.parametric(paths), solution, change=CHANGE, bounds=False)
    shown = actuator.goal.shown

    def moved(value: float | None) -> float | None:
        return None if value is None else shown(value + added)

    rows = []
    for price in parameter_prices:
        if price.value == 0 and abs(price.price) <= FREE * abs(solution.objective):
            continue
        quantity = _quantity(actuator, price.parameter)
        rows.append(
            Sensitivity(
                parameter=price.parameter,
                label=quantity.label,
                unit=quantity.unit,
                scale=unit(quantity.unit, quantity.dimension).scale if quantity.unit else 1.0,
                limit=price.value,
                price=shown(price.price),
                percent_per_percent=price.percent_per_percent,
                predicted_10=moved(price.predicted_up),
                resolved_10=moved(price.resolved_up),
                predicted_minus10=moved(price.predicted_down),
                resolved_minus10=moved(price.resolved_down),
                holds_until=price.holds_until,
                next_active=price.change,
                active=price.parameter in active,
                price_up=finite(shown(price.price_up)),
                price_down=finite(shown(price.price_down)),
                movement=dict(zip(actuator.paths, price.movement.tolist(), strict=True)),
            )
        )
    return ranked(rows, shown(solution.objective + added))


def _active_limits(actuator: ActuatorProblem, solution: Solution) -> set[str]:
    labels = set(solution.kkt.active) if solution.kkt is not None else set()
    return {
        row.limit_of.path
        for row in actuator.rows
        if row.label in labels and row.limit_of.path is not None
    }


def _quantity(actuator: ActuatorProblem, path: str) -> Quantity:
    if path.startswith("requirements."):
        return actuator.subject.quantities[path.removeprefix("requirements.").rpartition(".")[0]]
    return input_quantity(path, actuator.subject.design)


def _strongest(
    actuator: ActuatorProblem, solution: Solution, excluded: set[str]
) -> tuple[str, ...]:
    """The parameters to which the objective is most sensitive by the Lagrangian's derivatives."""
    if solution.kkt is None:
        return ()
    candidates = [
        path
        for path in actuator.fixed_numbers(solution.x)
        if path not in excluded
        and not path.startswith("requirements.")
        and _quantity(actuator, path).dimension not in NO_PERCENT
    ]
    if not candidates:
        return ()
    values = actuator.number_steps(solution.x, candidates)
    slope = np.imag(values.objective) - solution.kkt.multipliers @ np.imag(values.constraints)
    elasticity = np.nan_to_num(slope / STEP / abs(solution.objective or 1.0))
    order = np.argsort(-np.abs(elasticity), kind="stable")
    return tuple(
        candidates[i] for i in order[:MOST_PARAMETERS] if abs(elasticity[i]) >= LEAST_EFFECT
    )


PER_CENT = round(100 * CHANGE)


def display_of(row: Sensitivity, value: float | None) -> float | None:
    """A value of a row's parameter in its display unit; None for no value."""
    if value is None:
        return None
    offset = 273.15 if row.unit in ("degC", "°C") else 0.0
    return value / row.scale - offset


def short_name(row: Sensitivity) -> str:
    """A PATH shortened for use in a sentence: "stiffness_min", "density of ti_6al4v".

    >>> from types import SimpleNamespace as Row
    >>> short_name(Row(parameter="requirements.stiffness_min.min"))
    'stiffness_min'
    >>> short_name(Row(parameter="materials.ti_6al4v.density"))
    'density of ti_6al4v'
    """
    path = row.parameter
    if path.startswith("requirements."):
        return path.removeprefix("requirements.").rpartition(".")[0]
    if path.startswith("materials."):
        material, _, name = path.removeprefix("materials.").rpartition(".")
        return f"{name} of {material}"
    return path


def buys_most(
    best_offers: Offers, quantity: Quantity, objective: float, *, maximised: bool
) -> tuple[str, ...]:
    """Sentences on the most valuable changes, and on requirements that cannot be made stricter.

    Parameters
    ----------
    best_offers : the best change of each kind
    quantity, objective : the objective's quantity, and its value at the optimum (SI)
    maximised : whether a larger objective is better
    """

    def gain(offer: Offer) -> str:
        """The gain of a change in words: "saves 19.7 g (7.5 %)"."""
        per_display = quantity.to_display(1.0) - quantity.to_display(0.0)
        amount = f"{short(offer.gain * per_display, 3, full=True)} {quantity.unit}".rstrip()
        if objective:
            amount += f" ({short(100 * offer.gain / abs(objective), 2, full=True)} %)"
        return f"adds {amount}" if maximised else f"saves {amount}"

    if (best := best_offers.requirement) is not None:
        parts = [
            f"Relaxing {short_name(best.row)} by {PER_CENT} % (to {_at(best.row, best.value)}) "
            f"{gain(best)}, the most of any requirement."
        ]
    else:
        parts = [f"Relaxing any single requirement by {PER_CENT} % does not improve the objective."]
    for best, group in (
        (best_offers.parameter, "Among the design's fixed values"),
        (best_offers.material, "Among the material properties"),
    ):
        if best is not None:
            direction = "more" if best.change > 0 else "less"
            name, value = short_name(best.row), _at(best.row, best.value)
            parts.append(f"{group}, {PER_CENT} % {direction} {name} (to {value}) {gain(best)}.")
    if best_offers.no_design:
        infeasible = ", ".join(
            f"{short_name(row)} at {_at(row, row.limit * (1 + sign * CHANGE))}"
            for row, sign in best_offers.no_design
        )
        parts.append(f"The search found no feasible design with {infeasible}.")
    return tuple(parts)


def _at(row: Sensitivity, value: float) -> str:
    """A value of a row's parameter as text with its unit."""
    display = display_of(row, value)
    assert display is not None
    unit = "" if row.unit == "-" else row.unit
    return f"{short(display)} {unit}".rstrip()
