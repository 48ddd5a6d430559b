"""The outcome of every combination of the choices."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace

from ..design import Design
from ..design.choice_list import left_out
from .choices import EQUAL, ChoiceSearch
from .quick_look import Look
from .result import Choices, Combination, How


def record(found: ChoiceSearch, design: Design) -> Choices:
    """All combinations, the best first.

    Parameters
    ----------
    found : the finished search
    design : the design of the file
    """
    ranked, mendable = found.ranked(), found.mendable()
    best, rows = ranked[0], []
    least = best.objective if best.rounded is None else best.rounded
    for look in ranked:
        cost = None
        reached = look.objective if look.rounded is None else look.rounded
        if look.feasible and best.feasible and look.sizing not in _WITHOUT:
            cost = reached - least
            cost = 0.0 if abs(cost) <= EQUAL * abs(least) else cost
        rows.append(
            Combination(
                values=look.values,
                how=look.how,
                feasible=look.feasible,
                status=_status(look, mendable, best.rounded is not None),
                objective=found.goal.shown(look.objective)
                if math.isfinite(look.objective)
                else None,
                cost=cost,
                percent=100 * cost / abs(least) if cost and least else cost,
                rounded=None if look.rounded is None else found.goal.shown(look.rounded),
            )
        )
    made = Choices("", tuple(rows), left_out(design))
    return replace(made, sentence=_sentence(made))


def _status(look: Look, mendable: frozenset[str], sized: bool) -> str:
    """Return the search of a combination and its outcome, in words."""
    if look.fault:
        return f"not possible: {look.fault}"
    if look.how == "not tried":
        return "not tried: time limit reached"
    checks = ", ".join(sorted(look.checks & mendable))
    if look.feasible:
        said = (
            "all requirements are met" if look.solution is None else look.solution.outcome.sentence
        )
        if look.sizing:
            said = f"{said}; {_SIZING[look.sizing]}"
        elif look.rounded is None and sized:
            said = f"{said}; not searched further, as listed sizes cannot improve on the best"
        if checks:
            said = f"misses the check {checks}, which other choices meet; {said}"
    else:
        by = f" by {100 * look.violation:.2g} %" if math.isfinite(look.violation) else ""
        said = f"misses {look.missed}{by}" if look.missed else "no finite values at any point"
    return _WAYS[look.how] + said


_SIZING = {
    "found": "best with listed sizes",
    "sizes of the best": "with the sizes of the best",
    "none better": "none better with listed sizes",
    "none": "none with listed sizes",
    "no size fits": "no listed size within its bounds",
}
"""Result of the search for listed sizes."""

_WITHOUT = ("none", "none better", "no size fits")
"""Combinations without a design to compare."""

_WAYS: dict[How, str] = {"multistart": "many starts: ", "quick": "quick look: ", "evaluated": ""}


def _sentence(made: Choices) -> str:
    """Count the combinations, the feasible ones, and those of each search, in words."""
    total, fit = len(made.combinations), made.feasible
    first = f"none of {total} combinations meets all requirements; the nearest one is shown"
    if fit:
        first = f"the best of {total} combinations; {fit} meet all requirements"
    counts = ", ".join(_counts(made))
    proof = "; a quick look proves nothing" if made.count("quick") else ""
    return f"{first}; {counts}{proof}"


def _counts(made: Choices) -> Iterator[str]:
    words: dict[How, str] = {
        "evaluated": "evaluated",
        "multistart": "solved from many starts",
        "quick": "quick look only",
        "not possible": "not possible",
        "not tried": "not tried within the time limit",
    }
    for how, said in words.items():
        if count := made.count(how):
            yield f"{count} {said}"
