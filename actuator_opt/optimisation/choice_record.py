"""What became of every combination of the choices, in words and numbers."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace

from ..design import Design
from ..design.choice_list import left_out
from .choices import EQUAL, Search
from .quick_look import Look
from .result import Choices, Combination, How


def record(found: Search, design: Design) -> Choices:
    """Every combination, the best first.

    Parameters
    ----------
    found : the finished search
    design : the design of the file
    """
    ranked, mendable = found.ranked(), found.mendable()
    best, rows = ranked[0], []
    for look in ranked:
        cost = None
        if look.feasible and best.feasible:
            cost = look.objective - best.objective
            cost = 0.0 if abs(cost) <= EQUAL * abs(best.objective) else cost
        rows.append(
            Combination(
                values=look.values,
                how=look.how,
                feasible=look.feasible,
                status=_status(look, mendable),
                objective=found.goal.shown(look.objective)
                if math.isfinite(look.objective)
                else None,
                cost=cost,
                percent=100 * cost / abs(best.objective) if cost and best.objective else cost,
            )
        )
    made = Choices("", tuple(rows), left_out(design))
    return replace(made, sentence=_sentence(made))


def _status(look: Look, mendable: frozenset[str]) -> str:
    """How a combination was looked into, and what it came to."""
    if look.fault:
        return f"not possible: {look.fault}"
    if look.how == "not tried":
        return "not tried: the time was up"
    checks = ", ".join(sorted(look.checks & mendable))
    if look.feasible:
        said = (
            "every requirement is met" if look.solution is None else look.solution.outcome.sentence
        )
        if checks:
            said = f"misses the check {checks}, which other choices meet; {said}"
    else:
        by = f" by {100 * look.violation:.2g} %" if math.isfinite(look.violation) else ""
        said = f"misses {look.missed}{by}" if look.missed else "no point has finite values"
    return _WAYS[look.how] + said


_WAYS: dict[How, str] = {"multistart": "many starts: ", "quick": "quick look: ", "evaluated": ""}


def _sentence(made: Choices) -> str:
    """How many combinations there are, how many fit, and how they were looked into."""
    total, fit = len(made.combinations), made.feasible
    first = f"none of {total} combinations meets every requirement; the nearest is kept"
    if fit:
        first = f"the best of {total} combinations; {fit} meet every requirement"
    counts = ", ".join(_counts(made))
    proof = "; a quick look is no proof" if made.count("quick") else ""
    return f"{first}; {counts}{proof}"


def _counts(made: Choices) -> Iterator[str]:
    words: dict[How, str] = {
        "evaluated": "evaluated",
        "multistart": "solved from many starts",
        "quick": "looked at quickly",
        "not possible": "not possible",
        "not tried": "not tried in the time given",
    }
    for how, said in words.items():
        if count := made.count(how):
            yield f"{count} {said}"
