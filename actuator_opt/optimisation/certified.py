"""The certificate of an optimum: its proven bound, and the evidence of the starts."""

from __future__ import annotations

import math

from ..base.progress import tell
from .actuator import ActuatorProblem, Goal
from .outcome import Solution
from .result import Certificate, Optimisation

CHANCE = 0.95
"""Probability for the evidence of the starts."""

SAME = 1e-3
"""Relative difference of objectives up to which two starts reached the same optimum."""


def certified(actuator: ActuatorProblem, solution: Solution) -> Certificate:
    """Bound the distance of a feasible design from the best possible one.

    Parameters
    ----------
    actuator : the problem
    solution : its best design
    """
    evidence = _evidence(solution)
    reason = _unsuited(actuator, solution)
    if reason:
        return Certificate(f"no proof: {reason}", evidence)
    from .certificate.certify import certify  # loads the LP solver, so only on request
    from .certificate.relaxation import Unknown

    quantity = actuator.subject.quantities[actuator.goal.single or ""]
    best = solution.objective

    def told(value: float) -> None:
        tell("proving the bound", math.exp(value) / best)

    try:
        relaxed, found = certify(actuator, solution.x, best, seconds=math.inf, report=told)
    except Unknown as error:
        return Certificate(f"no proof: {error}", evidence)
    bound = min(math.exp(found.bound), best)
    gap = max(1 - bound / best, 0.0)
    chosen = " with these choices" if actuator.subject.design.choices else ""
    words = (
        f"no design within the bounds{chosen} that meets the covered limits has a "
        f"{quantity.label} below {quantity.text(bound, 5)}: this design is within "
        f"{_percent(gap)} of the best possible"
    )
    covers = tuple(dict.fromkeys(claim.limit.name for claim in relaxed.covered))
    dropped = {name: why for name, why in relaxed.dropped.items() if name not in covers}
    return Certificate(words, evidence, bound, gap, covers, dropped, found.boxes)


def enumerated(found: Optimisation, goal: Goal) -> Certificate | None:
    """The certificate from trying all combinations of the choices, if nothing else is free."""
    choices = found.choices
    if choices is None or not found.evaluation.met:
        return None
    if choices.count("not tried"):
        return Certificate("no proof: not every combination was evaluated", "")
    words = f"all {len(choices.combinations)} combinations were evaluated: "
    wish, value = goal.sign, found.objective_value
    met = [one.objective for one in choices.combinations if one.feasible and one.objective]
    best = min((wish * one for one in met), default=wish * value)
    words += "none that meets all requirements is better"
    if best < wish * value:  # a check that some combination meets outranks the objective
        words += ", except those that miss more of the check list"
    if goal.single is None or wish < 0 or not value > 0:
        return Certificate(words, "")
    return Certificate(words, "", best, 1 - best / value)


def _percent(share: float) -> str:
    """A gap in per cent, rounded upwards."""
    percent = 100 * share
    if percent < 0.01:
        return "0.01 %"
    digits = 2 if percent < 1 else 1
    return f"{math.ceil(percent * 10**digits) / 10**digits:.{digits}f} %"


def _unsuited(actuator: ActuatorProblem, solution: Solution) -> str:
    """Why an objective has no bound; empty if it has one."""
    if actuator.goal.single is None:
        return "a weighted sum of metrics cannot be bounded yet; minimise one metric"
    if actuator.goal.sign < 0:
        return "a maximised metric cannot be bounded yet; minimise a metric"
    if not solution.objective > 0:
        return "the objective is not positive"
    return ""


def _evidence(solution: Solution) -> str:
    """The evidence of the starts against a better optimum elsewhere."""
    count = len(solution.starts)
    if count == 0:
        return ""
    best = solution.objective
    same = sum(
        start.feasible and abs(start.objective - best) <= SAME * abs(best)
        for start in solution.starts
    )
    missed = 1 - (1 - CHANCE) ** (1 / count)
    return (
        f"{same} of {count} starts reached this optimum, none a better one. A better optimum "
        f"reached by more than {100 * missed:.0f} % of all starts would have been seen with "
        f"{100 * CHANCE:.0f} % probability (evidence, not proof)"
    )
