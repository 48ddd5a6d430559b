"""Shows how measured values change a design: its requirements and its optimum."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import hypot
from typing import Any, NamedTuple

from ..base.dataclass import dataclass
from ..base.errors import InputError
from ..base.quantities import Quantity
from ..design.build import with_values
from ..evaluation import Evaluation, PreparedDesign, evaluate, prepare
from ..evaluation.result import Requirement
from .infeasibility import change_text
from .result import Optimisation
from .run import optimise


@dataclass(frozen=True, slots=True)
class Shift:
    """A requirement evaluated with the old and the new values of the design.

    `lower` and `upper` enclose the requirement's new value (SI) for the measured uncertainties;
    they are None without uncertainties.
    """

    before: Requirement
    after: Requirement
    lower: float | None
    upper: float | None

    @property
    def move(self) -> float:
        """Change of the margin as a share of the limit; negative if the margin decreases."""
        if self.before.margin is None or self.after.margin is None:
            return 0.0
        return self.after.margin - self.before.margin

    @property
    def verdict(self) -> str:
        """Verdict on the requirement with the new values, in one word."""
        if self.before.met == self.after.met:
            return "still met" if self.after.met else "still missed"
        return "now met" if self.after.met else "now missed"

    def to_dict(self) -> dict[str, Any]:
        """As plain data for JSON, SI."""
        return {
            "name": self.after.name,
            "metric": self.after.metric,
            "sense": self.after.sense,
            "limit": self.after.limit,
            "before": self.before.value,
            "after": self.after.value,
            "lower": self.lower,
            "upper": self.upper,
            "margin_before": self.before.margin,
            "margin_after": self.after.margin,
            "verdict": self.verdict,
        }


class ObjectiveChange(NamedTuple):
    """A metric of the objective at the old and the new optimum (SI); None without an optimum."""

    metric: str
    quantity: Quantity
    before: float | None
    after: float | None


@dataclass(frozen=True, slots=True)
class Redesign:
    """Effect of new values on a design, which is evaluated as it is and optimised again.

    Parameters
    ----------
    evaluation : the unchanged design, evaluated with the new values
    shifts : every requirement with the old and the new values
    best_before, best_after : the optima with old and new values; None for a design without
        variables and choices
    """

    evaluation: Evaluation
    shifts: tuple[Shift, ...]
    best_before: Optimisation | None
    best_after: Optimisation | None

    @property
    def moved(self) -> Shift | None:
        """The requirement whose margin changed most; None if none changed."""
        if not self.shifts:
            return None
        largest = max(self.shifts, key=lambda shift: abs(shift.move))
        return largest if largest.move != 0 else None

    @property
    def sentences(self) -> tuple[str, ...]:
        """The changes in words."""
        sentences = [self._moved_words()]
        before, after = self.best_before, self.best_after
        if before is not None and after is not None:
            sentences += _optimum_words(before, after, self.goals)
        return tuple(sentences)

    @property
    def goals(self) -> tuple[ObjectiveChange, ...]:
        """The metrics of the objective at both optima; the terms of a weighted sum are separate.

        A weighted sum divides each term by that term's value for the design file, which the new
        values change. So the sums with old and new values cannot be compared.
        """
        before, after = self.best_before, self.best_after
        if before is None or after is None:
            return ()
        return tuple(
            ObjectiveChange(
                name, after.evaluation.metrics[name].quantity, *_values(name, before, after)
            )
            for name in after.design.objective.metrics
        )

    def _moved_words(self) -> str:
        largest = self.moved
        if largest is None:
            return "no requirement changes"
        quantity = self.evaluation.metrics[largest.after.metric].quantity
        low, high = largest.lower, largest.upper
        bounds = (
            ""
            if low is None or high is None
            else f" (uncertainty of the new value: {quantity.text(low)} to {quantity.text(high)})"
        )
        sign = "at least" if largest.after.sense == "min" else "at most"
        old = "-" if largest.before.value is None else quantity.text(largest.before.value)
        new = "-" if largest.after.value is None else quantity.text(largest.after.value)
        return (
            f"largest change: {largest.after.name} from {old} to {new}{bounds}, required {sign} "
            f"{quantity.text(largest.after.limit)}: {largest.verdict}"
        )

    def to_dict(self) -> dict[str, Any]:
        """As plain data for JSON, SI."""
        result: dict[str, Any] = {
            "requirements": [shift.to_dict() for shift in self.shifts],
            "moved": None if self.moved is None else self.moved.after.name,
            "sentences": list(self.sentences),
            "optimum": None,
        }
        before, after = self.best_before, self.best_after
        if before is not None and after is not None:
            previous = {variable.path: variable.value for variable in before.variables}
            result["optimum"] = {
                "objective": {
                    goal.metric: {"before": goal.before, "after": goal.after} for goal in self.goals
                },
                "status": {"before": before.status, "after": after.status},
                "variables": {
                    variable.path: {"before": previous.get(variable.path), "after": variable.value}
                    for variable in after.variables
                },
                "active": {"before": active(before), "after": active(after)},
            }
        return result


def solved(optimisation: Optimisation) -> bool:
    """Whether an optimisation found a feasible design."""
    return optimisation.evaluation.met and optimisation.infeasibility is None


def _values(name: str, *optima: Optimisation) -> list[float | None]:
    """The value of a metric at each optimum; None where no design meets the requirements."""
    return [
        optimum.evaluation.metrics[name].value if solved(optimum) else None for optimum in optima
    ]


def active(optimisation: Optimisation) -> list[str]:
    """Labels of the active limits of an optimum."""
    return [] if optimisation.kkt is None else list(optimisation.kkt.active)


def redesign(
    before: PreparedDesign,
    after: PreparedDesign,
    learned: Sequence[Mapping[str, tuple[float, float]]],
    *,
    seed: int = 0,
    search: bool = True,
) -> Redesign:
    """Evaluate the designs with old and new values; optimise both if they have variables.

    Each group of measured values is set to its lower and upper bounds while all other values stay
    unchanged. The resulting changes of a requirement are combined as the root of their sum of
    squares, separately upwards and downwards.

    Parameters
    ----------
    before, after : the design with the old and the new values
    learned : groups of measured values that vary together: lower and upper bounds by PATH
    seed : seed of the searches
    search : whether to optimise
    """
    evaluation_before, evaluation_after = evaluate(before), evaluate(after)
    bounds = _bounds(after, evaluation_after, learned)
    shifts = tuple(
        Shift(old, new, *bounds.get(new.name, (None, None)))
        for old, new in zip(
            evaluation_before.requirements, evaluation_after.requirements, strict=True
        )
    )
    has_choice = after.design.variables or after.design.choices
    if not (search and has_choice and after.design.requirements):
        return Redesign(evaluation_after, shifts, None, None)
    optima = [optimise(subject, seed=seed, prices=False) for subject in (before, after)]
    return Redesign(evaluation_after, shifts, *optima)


def _bounds(
    subject: PreparedDesign,
    middle: Evaluation,
    learned: Sequence[Mapping[str, tuple[float, float]]],
) -> dict[str, tuple[float | None, float | None]]:
    """By requirement, the range of its value while the measured values vary within their bounds."""
    values = {row.name: row.value for row in middle.requirements}
    reach = dict.fromkeys(values, (0.0, 0.0))
    for group in learned:
        ends = []
        for end in (0, 1):
            numbers = {path: bounds[end] for path, bounds in group.items()}
            try:
                design = with_values(subject.design, numbers)
            except InputError:
                return {}
            ends.append(evaluate(prepare(design, plugins=subject.plugins)).requirements)
        for at_lower, at_upper in zip(*ends, strict=True):
            middle_value = values[at_lower.name]
            if at_lower.value is None or at_upper.value is None or middle_value is None:
                continue
            down, up = reach[at_lower.name]
            reach[at_lower.name] = (
                hypot(down, max(middle_value - min(at_lower.value, at_upper.value), 0.0)),
                hypot(up, max(max(at_lower.value, at_upper.value) - middle_value, 0.0)),
            )
    return {
        name: (None, None) if value is None else (value - reach[name][0], value + reach[name][1])
        for name, value in values.items()
    }


def _optimum_words(
    before: Optimisation, after: Optimisation, goals: Sequence[ObjectiveChange]
) -> list[str]:
    """Sentences on how the optimum and its active limits changed."""
    if not (solved(before) and solved(after)):
        states = [
            "a design meets all requirements"
            if solved(optimum)
            else "no design meets all requirements"
            for optimum in (before, after)
        ]
        return [f"before, {states[0]}; now, {states[1]}", *_repairs(after)]
    parts = [_goal_words(goal) for goal in goals]
    return [f"the best design: {', '.join(parts)}", *_active_words(active(before), active(after))]


def _goal_words(objective_change: ObjectiveChange) -> str:
    """A metric of the objective with old and new values, in words."""
    old, new = objective_change.before, objective_change.after
    if old is None or new is None:
        return f"{objective_change.metric} has no value"
    old_text, new_text = (objective_change.quantity.text(x, 5) for x in (old, new))
    if old_text == new_text:
        return f"{objective_change.metric} stays {new_text}"
    change = f" ({100 * (new / old - 1):+.1f} %)" if old else ""
    return f"{objective_change.metric} {old_text} to {new_text}{change}"


def _repairs(optimisation: Optimisation) -> list[str]:
    """Remedies in words: a single change that is enough, and the smallest change of limits."""
    if optimisation.infeasibility is None:
        return []
    first_cure = next((cure for cure in optimisation.infeasibility.cures if cure["advised"]), None)
    single = (
        [] if first_cure is None else [f"this change alone is enough: {change_text(first_cure)}"]
    )
    joint = optimisation.infeasibility.joint
    changes = "; ".join(change_text(row) for row in joint)
    unsafe = any(row["safety_factor"] for row in joint)
    warned = " (this weakens a safety factor: not advised)" if unsafe else ""
    joint_change = (
        [f"the smallest change of limits that is enough: {changes}{warned}"] if changes else []
    )
    return [*single, *joint_change]


def _active_words(old: Sequence[str], new: Sequence[str]) -> list[str]:
    """Sentences on the limits that became active or inactive at the optimum."""
    pairs = (
        ([limit for limit in new if limit not in old], "newly at its limit"),
        ([limit for limit in old if limit not in new], "no longer at its limit"),
    )
    return [f"{change}: {', '.join(names)}" for names, change in pairs if names]
