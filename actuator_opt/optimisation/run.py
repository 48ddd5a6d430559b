"""Optimise an actuator: problem, solution, prices and, if infeasible, the reason."""

from __future__ import annotations

import time
from dataclasses import dataclass, replace

from ..design import quantity_of
from ..evaluation import Evaluation, PreparedDesign, evaluate
from .actuator import ActuatorProblem, Fault, build, idle_metrics, require_movable_objective
from .certified import certified, enumerated
from .choice_record import record
from .choice_sizes import Sized, best_of_sizes
from .choices import MOST_SOLVED, ChoiceSearch, Settings, search
from .infeasibility_card import explained
from .outcome import Outcome, Solution
from .price_table import sensitivities
from .result import Certificate, Choices, Infeasibility, Kkt, Optimisation, Rounding, VariableResult
from .rounding import Wanted, design_at, rounded, sizes_of
from .sensitivity import Sensitivity
from .solver import solve

SAMPLES = 2048
"""Points of the global sweep: on every shipped design three seeds of 8192, 2048 and 1024 points led
to the same optimum. With poles and margins the sweep takes most of the time."""


def optimise(
    subject: PreparedDesign,
    *,
    fault: Fault | None = None,
    algorithm: str = "auto",
    starts: int = 6,
    seed: int = 0,
    prices: bool = True,
    max_seconds: float | None = None,
    whole_plies: bool = False,
    standard_sizes: bool = False,
    certify: bool = False,
    keep_interrupted: bool = False,
    explain: bool = True,
) -> Optimisation:
    """Find the best design.

    Parameters
    ----------
    subject : the prepared design
    fault : locates faults of variables in the file
    algorithm : "auto" or an NLopt name such as ``LD_SLSQP``
    starts : starts taken from the global sweep
    seed : of sweep and stochastic algorithms; the same seed gives the same result
    prices : price requirements and parameters (and re-solve at ±10 %)
    max_seconds : time limit of the search; the best design so far is kept
    whole_plies : also find the best design of whole plies and allowed angles
    standard_sizes : also find the best design with all standard sizes
    certify : prove the distance of the design from the best possible
    explain : explain an infeasible result
    keep_interrupted : Ctrl-C keeps the best design so far (without choices)
    """
    began = time.perf_counter()
    until = None if max_seconds is None else began + max_seconds
    wanted = Wanted(whole_plies, standard_sizes)
    sizes = sizes_of(subject.design, wanted, subject.materials, fault)
    sized: Sized | None = None
    choices: Choices | None = None
    if subject.design.choices:
        settings = Settings(algorithm, starts, SAMPLES, seed, until)
        found = search(subject, settings, MOST_SOLVED if sizes is None else 1)
        if sizes is not None:
            sized = best_of_sizes(found, wanted, settings)
        choices = record(found, subject.design)
        best = found.ranked()[0] if sized is None else sized.look
        if best.actuator is None or best.solution is None:
            only = _enumerated(subject, found, choices, seed, began)
            return replace(only, certificate=enumerated(only, found.goal)) if certify else only
        actuator, solution = best.actuator, best.solution
    else:
        actuator = build(subject, fault)
        require_movable_objective(actuator)
        solution = solve(
            actuator.problem,
            algorithm=algorithm,
            starts=starts,
            samples=SAMPLES,
            seed=seed,
            max_seconds=max_seconds,
            keep_interrupted=keep_interrupted,
        )
    after = _After(solution)
    try:
        if sizes is not None and solution.feasible and not solution.interrupted:
            kept = (sizes, None) if sized is None else (sized.sizes, sized.found)
            after.rounding, after.solution = rounded(
                actuator, solution, *kept, until=until, seed=seed
            )
        _follow(actuator, after, prices=prices, certify=certify, explain=explain)
    except KeyboardInterrupt:
        if not keep_interrupted:
            raise
        ended = Outcome.INTERRUPTED if solution.feasible else Outcome.INTERRUPTED_INFEASIBLE
        after = _After(replace(solution, outcome=ended))
    return _result(subject, actuator, after, choices, seed, began)


def result_of(
    subject: PreparedDesign,
    actuator: ActuatorProblem,
    solution: Solution,
    *,
    prices: bool,
    seed: int,
    began: float,
    start: Evaluation | None = None,
) -> Optimisation:
    """The optimisation for a known solution, with or without prices.

    Parameters
    ----------
    subject, actuator, solution : the prepared design, its problem and the solution
    prices : as of `optimise`
    seed : of the search
    began : time of `time.perf_counter` when it began
    start : start of the search; default: the design as stated
    """
    after = _After(solution)
    _follow(actuator, after, prices=prices, certify=False, explain=False)
    return _result(subject, actuator, after, None, seed, began, start)


@dataclass
class _After:
    """The solution and its follow-up results."""

    solution: Solution
    rounding: Rounding | None = None
    why: Infeasibility | None = None
    rows: tuple[Sensitivity, ...] = ()
    certificate: Certificate | None = None


def _follow(
    actuator: ActuatorProblem, after: _After, *, prices: bool, certify: bool, explain: bool
) -> None:
    """Explain, certify and price a solution."""
    if after.solution.interrupted:
        return
    if explain:
        after.why, after.solution = explained(actuator, after.solution)
    if certify and after.solution.feasible:
        after.certificate = certified(actuator, after.solution)
    if prices and after.solution.outcome is Outcome.OPTIMUM:
        after.rows = sensitivities(actuator, after.solution)


def _result(
    subject: PreparedDesign,
    actuator: ActuatorProblem,
    after: _After,
    choices: Choices | None,
    seed: int,
    began: float,
    start: Evaluation | None = None,
) -> Optimisation:
    """Assemble the result."""
    solution = after.solution
    design, evaluation = design_at(actuator, solution.x)
    return Optimisation(
        status=solution.outcome.status,
        sentence=solution.outcome.sentence,
        remedy=solution.outcome.remedy,
        objective_metric=actuator.goal.single or "weighted",
        objective_value=actuator.goal.shown(solution.objective),
        design=design,
        evaluation=evaluation,
        start=evaluate(subject) if start is None else start,
        variables=_variables(actuator, solution),
        kkt=_kkt(solution),
        sensitivities=after.rows,
        infeasibility=after.why,
        evaluations=solution.evaluations,
        samples=solution.samples,
        starts=tuple(
            actuator.goal.shown(record.objective) if record.feasible else None
            for record in solution.starts
        ),
        trace=tuple((n, actuator.goal.shown(f), missed) for n, f, missed in solution.trace),
        algorithm=solution.algorithm,
        warnings=(
            *solution.warnings,
            *(f"variable without effect: {name}" for name in solution.without_effect),
            *_idle(actuator),
            *actuator.refusals.warnings(),
        ),
        seed=seed,
        seconds=time.perf_counter() - began,
        certificate=after.certificate,
        rounding=after.rounding,
        choices=choices,
    )


def _idle(actuator: ActuatorProblem) -> tuple[str, ...]:
    """Objective terms that no variable affects, as warnings."""
    if actuator.goal.single is not None:
        return ()
    return tuple(f"objective: no variable affects {name}" for name in idle_metrics(actuator))


def _enumerated(
    subject: PreparedDesign, found: ChoiceSearch, choices: Choices, seed: int, began: float
) -> Optimisation:
    """The best combination of the choices, if nothing else is free."""
    best = found.ranked()[0]
    assert best.subject is not None
    status, remedy = "optimal", ""
    if not best.feasible:
        status, remedy = "infeasible", "relax the requirement it misses, or add values to choices"
    return Optimisation(
        status=status,
        sentence=choices.sentence,
        remedy=remedy,
        objective_metric=found.goal.single or "weighted",
        objective_value=found.goal.shown(best.objective),
        design=best.subject.design,
        evaluation=evaluate(best.subject),
        start=evaluate(subject),
        variables=(),
        kkt=None,
        sensitivities=(),
        infeasibility=None,
        evaluations=choices.tried,
        samples=0,
        starts=(),
        trace=(),
        algorithm="enumeration of the choices",
        warnings=(),
        seed=seed,
        seconds=time.perf_counter() - began,
        choices=choices,
    )


def _variables(actuator: ActuatorProblem, solution: Solution) -> tuple[VariableResult, ...]:
    problem, design = actuator.problem, actuator.subject.design
    return tuple(
        VariableResult(
            path=path,
            quantity=quantity_of(path, design).name,
            value=float(solution.x[i]),
            start=None if problem.start is None else float(problem.start[i]),
            lower=float(problem.lower[i]),
            upper=float(problem.upper[i]),
            at_bound=solution.at_bound(i),
        )
        for i, path in enumerate(actuator.paths)
    )


def _kkt(solution: Solution) -> Kkt | None:
    found = solution.kkt
    if found is None:
        return None
    curvature = "" if found.curvature is None else found.curvature.value
    return Kkt(float(found.residual), found.active, int(found.rank), curvature)
