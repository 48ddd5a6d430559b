"""Evaluate, optimise, price."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from ..design import Design
from ..errors import InputError
from ..evaluation import Evaluation, Subject
from ..evaluation import evaluate as evaluate_subject
from .actuator import Actuator, Plugins, as_actuator, located, place, unanswered

if TYPE_CHECKING:
    from ..optimisation.result import Optimisation
    from ..optimisation.sensitivity import Sensitivity


def evaluate(design: Actuator | Design | str | Path, *, plugins: Plugins = ()) -> Evaluation:
    """Every metric, requirement and check of a design as it stands."""
    return evaluate_subject(as_actuator(design, plugins).subject())


def optimise(
    design: Actuator | Design | str | Path,
    *,
    algorithm: str = "auto",
    starts: int = 6,
    seed: int = 0,
    plugins: Plugins = (),
    prices: bool = True,
    max_seconds: float | None = None,
    whole_plies: bool = False,
    keep_interrupted: bool = False,
    standard_sizes: bool = False,
    certify: bool = False,
    yield_target: float | None = None,
) -> Optimisation:
    """The best design; parameters as `optimisation.run.optimise`.

    With a `yield_target` all limits hold with that probability while the design's numbers scatter
    (`scatter.robust`); `robust` of the result says how.
    """
    from ..optimisation.run import optimise as run

    actuator = as_actuator(design, plugins)
    subject = actuator.subject()
    faults = unanswered(actuator, subject)
    if faults:
        raise InputError(faults)

    def search(subject: Subject, last: bool) -> Optimisation:
        return run(
            subject,
            fault=place(actuator),
            algorithm=algorithm,
            starts=starts,
            seed=seed,
            prices=prices and last,
            max_seconds=max_seconds,
            whole_plies=whole_plies,
            standard_sizes=standard_sizes,
            certify=certify and last,
            explain=last,
            keep_interrupted=keep_interrupted,
        )

    with located(actuator):
        if yield_target is None:
            return search(subject, True)
        from ..scatter.robust import robust

        return robust(subject, yield_target, search, seed=seed)


def sensitivity(
    design: Actuator | Design | str | Path, *, seed: int = 0, plugins: Plugins = ()
) -> tuple[Sensitivity, ...]:
    """What each requirement and parameter costs at the design's optimum."""
    return optimise(design, seed=seed, plugins=plugins).sensitivities
