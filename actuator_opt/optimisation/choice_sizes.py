"""The best combination of the choices where variables keep to listed sizes.

The combinations are searched best first, each from its continuous optimum, which bounds what its
sizes can come to: those whose bound is no better than the best design of listed sizes so far are
left. The bounds are local optima, and mostly of a quick look: the best found, no proof.
"""

from __future__ import annotations

import math
import time
from dataclasses import dataclass

from ..errors import InputError
from .branch_and_bound import Found, Memory, search
from .choices import Search, Settings, many_starts
from .quick_look import Look
from .rounding import Sizes, Wanted, sizes_of


@dataclass(frozen=True)
class Sized:
    """A combination with its sizes and what the search of them came to."""

    look: Look
    sizes: Sizes
    found: Found


def best_of_sizes(choices: Search, wanted: Wanted, settings: Settings) -> Sized | None:
    """The combination with the best design of listed sizes; the winner is solved in full.

    Where no combination has any, that with the best continuous optimum; None where this one has no
    variable with sizes.

    Raises
    ------
    InputError
        the sizes that are asked fit no combination
    """
    first: Sized | None = None
    best: Sized | None = None
    error: InputError | None = None
    memories: dict[object, Memory] = {}
    mendable = choices.mendable()
    for look in choices.ranked():
        if not look.feasible or look.actuator is None or look.x is None:
            continue
        late = settings.until is not None and time.perf_counter() > settings.until
        worst = (len(look.checks & mendable), look.objective)
        if late or (best is not None and worst >= _rank(best, mendable)):
            break
        try:
            sizes = sizes_of(look.actuator.subject.design, wanted)
        except InputError as fault:
            error, look.sizing = error or fault, "no size fits"
            continue
        if sizes is None:
            continue
        below = (
            float("inf") if best is None or best.found.objective is None else best.found.objective
        )
        key = tuple((one.index, one.rows.tobytes()) for one in sizes.listed)
        found = search(
            look.actuator.problem,
            sizes.listed,
            look.x,
            until=settings.until,
            below=math.inf if below is None else below,
            memory=memories.setdefault(key, Memory()),
        )
        sized = Sized(look, sizes, found)
        look.sizing, look.rounded = "none found" if best is None else "none better", found.objective
        first = first or sized
        if found.objective is not None:
            best = sized
    if best is None and first is None and error is not None:
        raise error
    winner = best or first
    if winner is not None and winner.look.solution is None:
        many_starts(winner.look, settings)
    return winner


def _rank(sized: Sized, mendable: frozenset[str]) -> tuple[int, float]:
    objective = sized.found.objective
    assert objective is not None
    return len(sized.look.checks & mendable), objective
