"""The best combination of choices when variables take listed sizes.

Combinations are searched best first, each from its continuous optimum, which bounds its result with
sizes. Those whose bound does not beat the best sized design so far are skipped. The bounds are
local optima, mostly of a quick look, so the result is the best found, without proof.
"""

from __future__ import annotations

import math
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from ..base.errors import InputError
from .branch_and_bound import Found, Memory, at, search
from .choices import ChoiceSearch, Settings, many_starts
from .identical_problems import Evidence
from .quick_look import Look
from .rounding import RUNNERS_UP, Sizes, Wanted, sizes_of

_NOTHING_BETTER = Found(None, None, None, {}, 0, complete=True)
"""Same result as another combination."""


@dataclass(frozen=True)
class Sized:
    """A combination with its sizes and their search result."""

    look: Look
    sizes: Sizes
    found: Found
    memory: Memory


def best_of_sizes(choices: ChoiceSearch, wanted: Wanted, settings: Settings) -> Sized | None:
    """Find the combination with the best design of listed sizes, solved from many starts.

    If none fits, the combination with the best continuous optimum; None if no variable has sizes.

    Raises
    ------
    InputError
        the requested sizes fit no combination
    """
    searched = list(_searched(choices, wanted, settings))
    better = [sized for sized in searched if sized.found.objective is not None]
    winner = next(iter([*reversed(better), *searched]), None)
    if winner is None:
        return None
    if better:
        _runners_up(winner, searched)
    if winner.look.solution is None:
        many_starts(winner.look, settings)
    return winner


def _searched(choices: ChoiceSearch, wanted: Wanted, settings: Settings) -> Iterator[Sized]:
    """Search each promising combination for a better design than those before."""
    error: InputError | None = None
    memories: dict[object, Memory] = {}
    alike: dict[object, list[Evidence]] = {}
    mendable = choices.mendable()
    best, count = (math.inf, math.inf), 0
    for look in choices.ranked():
        if not look.feasible or look.actuator is None or look.x is None:
            continue
        checks = len(look.checks & mendable)
        late = settings.until is not None and time.perf_counter() > settings.until
        if (count and late) or (checks, look.objective) >= best:
            break
        try:
            subject = look.actuator.subject
            sizes = sizes_of(subject.design, wanted, subject.materials)
        except InputError as fault:
            error, look.sizing = error or fault, "no size fits"
            continue
        if sizes is None:
            continue
        key = tuple((one.index, one.rows.tobytes()) for one in sizes.listed)
        memory = memories.setdefault(key, Memory())
        problem = look.actuator.problem
        if any(one.holds_for(problem, look.objective) for one in alike.get(key, ())):
            look.sizing = "none" if best[1] == math.inf else "none better"
            yield Sized(look, sizes, _NOTHING_BETTER, memory)
            continue
        found = search(
            problem, sizes.listed, look.x, until=settings.until, below=best[1], memory=memory
        )
        if found.complete:
            alike.setdefault(key, []).append(Evidence(problem, look.objective, found.ends))
        look.rounded, count = found.objective, count + 1
        if found.objective is not None:
            look.sizing, best = "found", (checks, found.objective)
        else:
            look.sizing = "none" if best[1] == math.inf else "none better"
        yield Sized(look, sizes, found, memory)
    if not count and error is not None:
        raise error


def _runners_up(winner: Sized, searched: Sequence[Sized]) -> None:
    """Add the cost of the best sizes in the next best combinations."""
    assert winner.found.assignment is not None
    others = [sized for sized in searched if sized.look.sizing == "none better"]
    for sized in others[:RUNNERS_UP]:
        look = sized.look
        if sized.memory is not winner.memory or look.actuator is None or look.x is None:
            continue
        problem, listed = look.actuator.problem, sized.sizes.listed
        objective = at(problem, listed, winner.found.assignment, look.x, sized.memory)
        if objective is not None:
            look.rounded, look.sizing = objective, "sizes of the best"
