"""Designs with other words, such as a material or a joint, re-solved from a known optimum."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ..base.threads import one_thread
from .actuator import located, require_changes
from .sessions import SAMPLES, STARTS, Session

if TYPE_CHECKING:
    from ..optimisation.result import Optimisation


class Variant(NamedTuple):
    """A design with other words: its optimum, and a session there, or None if nothing fits."""

    optimum: Optimisation
    session: Session | None


@one_thread()
def variant(
    session: Session,
    changes: Mapping[str, float | str | None],
    *,
    thorough: bool = False,
    stop: Callable[[], bool] | None = None,
) -> Variant:
    """The optimum of a session's design with other words, and a session there.

    If the free dimensions stay the same, the search starts from the session's optimum, as in
    `Session.solve`. Otherwise, or with `thorough`, a full search has this optimum as one of its
    starts; a dimension that only the new design has starts at its value in the file.

    Parameters
    ----------
    session : the session
    changes : words and numbers by PATH, relative to the session's design; None removes the key
    thorough : whether to search the whole range, which may find a better optimum elsewhere
    stop : as for `Session.solve`

    Raises
    ------
    InputError
        the words do not suit the design, or leave a requirement without meaning
    """
    from ..optimisation.run import result_of
    from ..optimisation.solver import solve
    from ..optimisation.warm_start import WarmStart

    began = time.perf_counter()
    require_changes(changes, unset=True)
    with located(session._actuator):
        actuator = session._actuator.changed(changes)
    subject, problem = session._built(actuator)
    box, warm, seed = problem.problem, session._warm, session._seed
    if not thorough and tuple(problem.paths) == tuple(warm.actuator.paths):
        solution = warm.solve(box, stop)
    else:
        known, values = session._named(warm.point.x), subject.numbers
        start = np.array([known.get(path, values[path]) for path in problem.paths])
        solution = solve(
            box,
            starts=STARTS,
            samples=SAMPLES,
            more_starts=[box.inside(start)],
            seed=seed,
            stop=stop,
        )
    optimum = result_of(subject, problem, solution, prices=False, seed=seed, began=began)
    if not solution.feasible:
        return Variant(optimum, None)
    moved = object.__new__(Session)
    moved.optimum = optimum
    moved._start(actuator, seed, WarmStart(problem, solution, warm.effort))
    return Variant(optimum, moved)
