"""Optimises an actuator: solves, rounds to sizes, prices, proves, or explains infeasibility."""

from __future__ import annotations

import math
import time
from dataclasses import replace
from typing import Any

from ..base.cluster import HERE, Cluster
from ..base.dataclass import dataclass
from ..base.progress import tell
from ..design import quantity_of
from ..evaluation import Evaluation, PreparedDesign, evaluate
from ..evaluation.kernel import with_few_samples
from .actuator import ActuatorProblem, Fault, Goal, build, idle_metrics, require_movable_objective
from .choices import (
    MOST_SOLVED,
    ChoiceSearch,
    ChoiceSettings,
    Sized,
    best_of_sizes,
    record,
    search_choices,
)
from .infeasibility import explained
from .price_table import Sensitivity, priced
from .result import Certificate, Choices, Infeasibility, Kkt, Optimisation, Rounding, VariableResult
from .rounding import Wanted, design_at, rounded, sizes_of
from .solution import Outcome, Solution
from .solver import solve

CHANCE = 0.95
"""Confidence level of the statistical evidence for the optimum (see `Certificate.evidence`)."""
SAME = 1e-3
"""Relative difference of the objective up to which a start counts as having reached the optimum."""


def certified(actuator: ActuatorProblem, solution: Solution) -> Certificate:
    """Prove how far a feasible design can be from the best possible design.

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
    objective = solution.objective

    def told(value: float) -> None:
        tell("proving the bound", math.exp(value) / objective)

    try:
        relaxed, proof = certify(actuator, solution.x, objective, seconds=math.inf, report=told)
    except Unknown as error:
        return Certificate(f"no proof: {error}", evidence)
    bound = min(math.exp(proof.bound), objective)
    gap = max(1 - bound / objective, 0.0)
    condition = " with these choices" if actuator.subject.design.choices else ""
    sentence = (
        f"no design within the bounds{condition} that meets the limits covered by the "
        f"proof has a {quantity.label} below {quantity.text(bound, 5)}, so this design is "
        f"within {_percent(gap)} of the best possible"
    )
    covers = tuple(dict.fromkeys(claim.limit.name for claim in relaxed.covered))
    dropped = {name: why for name, why in relaxed.dropped.items() if name not in covers}
    return Certificate(sentence, evidence, bound, gap, covers, dropped, proof.boxes)


def enumerated(optimisation: Optimisation, goal: Goal) -> Certificate | None:
    """The certificate of a design that has choices but no variables; None if not applicable."""
    choices = optimisation.choices
    if choices is None or not optimisation.evaluation.met:
        return None
    if choices.count("not tried"):
        return Certificate("no proof: not every combination was evaluated", "")
    sentence = f"all {len(choices.combinations)} combinations were evaluated: "
    sign, value = goal.sign, optimisation.objective_value
    objectives = [
        combination.objective
        for combination in choices.combinations
        if combination.feasible and combination.objective
    ]
    best = min((sign * objective for objective in objectives), default=sign * value)
    sentence += "none that meets all requirements is better"
    if best < sign * value:  # checks met count before the objective
        sentence += ", except combinations that fail more checks of the check list"
    if goal.single is None or sign < 0 or not value > 0:
        return Certificate(sentence, "")
    return Certificate(sentence, "", best, 1 - best / value)


def _percent(share: float) -> str:
    """The gap to the best possible design in per cent, rounded upwards."""
    percent = 100 * share
    if percent < 0.01:
        return "0.01 %"
    digits = 2 if percent < 1 else 1
    return f"{math.ceil(percent * 10**digits) / 10**digits:.{digits}f} %"


def _unsuited(actuator: ActuatorProblem, solution: Solution) -> str:
    """The reason why no bound can be proven; empty if a proof is possible."""
    if actuator.goal.single is None:
        return "bounds for a weighted sum of metrics are not implemented; minimise a single metric"
    if actuator.goal.sign < 0:
        return "bounds for a maximised metric are not implemented; minimise a metric"
    if not solution.objective > 0:
        return "the objective is not positive"
    return ""


def _evidence(solution: Solution) -> str:
    """Sentence on how strongly the starts of the search suggest that there is no better optimum."""
    count = len(solution.starts)
    if count == 0:
        return ""
    best = solution.objective
    count_same = sum(
        start.feasible and abs(start.objective - best) <= SAME * abs(best)
        for start in solution.starts
    )
    missed = 1 - (1 - CHANCE) ** (1 / count)
    return (
        f"{count_same} of {count} starts reached this optimum, and none reached a better "
        f"one. If a better optimum were reached from more than {100 * missed:.0f} % of all "
        f"possible starts, this search would have found it with {100 * CHANCE:.0f} % "
        "probability (evidence, not proof)"
    )


SAMPLES = 2048
"""Number of points of the global sweep. For every shipped design, 8192, 2048 and 1024 points led to
the same optimum, with three seeds each. With hydraulic poles and stability margins, the sweep takes
most of the time."""


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
    shop: bool = False,
    certify: bool = False,
    keep_interrupted: bool = False,
    explain: bool = True,
    cluster: Cluster = HERE,
) -> Optimisation:
    """Find the best design of an actuator; parameters not listed here as for `api.optimise`.

    Parameters
    ----------
    subject : the prepared design
    fault : builds the Diagnostic of a faulty variable, with its line in the file
    explain : whether to explain an infeasible result
    cluster : workers for combinations of choices (see `choices`)
    """
    began = time.perf_counter()
    deadline = None if max_seconds is None else began + max_seconds
    requested = Wanted(whole_plies, standard_sizes, shop)
    sizes = sizes_of(subject.design, requested, subject.materials, fault)
    sized: Sized | None = None
    choices: Choices | None = None
    if subject.design.choices:
        settings = ChoiceSettings(algorithm, starts, SAMPLES, seed, deadline)
        most_solved = MOST_SOLVED if sizes is None else 1
        choice_search = search_choices(subject, settings, most_solved, cluster)
        if sizes is not None:
            sized = best_of_sizes(choice_search, requested, settings)
        choices = record(choice_search, subject.design)
        best = choice_search.ranked()[0] if sized is None else sized.look
        if best.actuator is None or best.solution is None:
            return _enumerated(subject, choice_search, choices, seed, began, certify=certify)
        actuator, solution = best.actuator, best.solution
    else:
        actuator = build(subject, fault)
        require_movable_objective(actuator)
        solution = _searched(
            actuator, fault, algorithm=algorithm, starts=starts, samples=SAMPLES, seed=seed,
            max_seconds=max_seconds, keep_interrupted=keep_interrupted,
        )  # fmt: skip
    follow_up = _FollowUp(solution)
    try:
        if sizes is not None and solution.feasible and not solution.interrupted:
            found = (sizes, None) if sized is None else (sized.sizes, sized.size_search)
            follow_up.rounding, follow_up.solution = rounded(
                actuator, solution, *found, until=deadline, seed=seed
            )
        _complete(actuator, follow_up, prices=prices, certify=certify, explain=explain)
    except KeyboardInterrupt:
        if not keep_interrupted:
            raise
        follow_up = _FollowUp(_interrupted(solution))
    return _result(subject, actuator, follow_up, choices, seed, began)


def _interrupted(solution: Solution) -> Solution:
    """The solution, marked as that of an interrupted search."""
    outcome = Outcome.INTERRUPTED if solution.feasible else Outcome.INTERRUPTED_INFEASIBLE
    return replace(solution, outcome=outcome)


def _searched(actuator: ActuatorProblem, fault: Fault | None, **settings: Any) -> Solution:
    """Solve; with long duty cycles first for few of their samples, then from there for all."""
    subject = with_few_samples(actuator.subject)
    if subject is actuator.subject:
        return _confirmed(actuator, **settings)
    few = build(subject, fault)
    first = _confirmed(few, **settings)
    again = settings | {"starts": 1, "samples": 0, "check": bool(first.warnings)}
    if settings["max_seconds"] is not None:
        again["max_seconds"] = max(settings["max_seconds"] - first.seconds, 0.0)
    if first.interrupted:
        again["max_evaluations"] = 1
    problem = replace(actuator.problem, start=first.x)
    found = _confirmed(replace(actuator, problem=problem), **again)
    if first.interrupted:
        return _interrupted(found)
    if first.feasible and not found.feasible and settings["max_seconds"] is None:
        return _confirmed(actuator, **settings)
    return replace(
        found,
        starts=first.starts,
        samples=first.samples,
        feasible_samples=first.feasible_samples,
        undefined=first.undefined,
        evaluations=first.evaluations + found.evaluations,
        gradients=first.gradients + found.gradients,
    )


def _confirmed(actuator: ActuatorProblem, **settings: Any) -> Solution:
    """Solve; if the recorded models are wrong at the optimum, solve with the models themselves."""
    solution = solve(actuator.problem, **settings)
    if actuator.confirmed(solution.x):
        return solution
    return solve(actuator.problem, **settings)


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
    """The optimisation result for a solution already known, with or without prices.

    Parameters
    ----------
    subject, actuator, solution : the prepared design, its problem and the solution
    prices : see `optimise`
    seed : seed of the search
    began : time of `time.perf_counter` at which the search began
    start : evaluation of the start; default: the design with the values of its file
    """
    follow_up = _FollowUp(solution)
    _complete(actuator, follow_up, prices=prices, certify=False, explain=False)
    return _result(subject, actuator, follow_up, None, seed, began, start)


@dataclass
class _FollowUp:
    """The solution, with the explanation, prices, certificate and rounding computed from it."""

    solution: Solution
    rounding: Rounding | None = None
    infeasibility: Infeasibility | None = None
    rows: tuple[Sensitivity, ...] = ()
    notes: tuple[str, ...] = ()
    certificate: Certificate | None = None


def _complete(
    actuator: ActuatorProblem, follow_up: _FollowUp, *, prices: bool, certify: bool, explain: bool
) -> None:
    """Explain an infeasible solution; compute certificate and prices of a feasible solution."""
    if follow_up.solution.interrupted:
        return
    if explain:
        follow_up.infeasibility, follow_up.solution = explained(actuator, follow_up.solution)
    if certify and follow_up.solution.feasible:
        follow_up.certificate = certified(actuator, follow_up.solution)
    if prices and follow_up.solution.outcome is Outcome.OPTIMUM:
        follow_up.rows, follow_up.notes = priced(actuator, follow_up.solution)


def _result(
    subject: PreparedDesign,
    actuator: ActuatorProblem,
    follow_up: _FollowUp,
    choices: Choices | None,
    seed: int,
    began: float,
    start: Evaluation | None = None,
) -> Optimisation:
    """Assemble the result of an optimisation."""
    solution = follow_up.solution
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
        sensitivities=follow_up.rows,
        infeasibility=follow_up.infeasibility,
        evaluations=solution.evaluations,
        samples=solution.samples,
        starts=tuple(
            actuator.goal.shown(record.objective) if record.feasible else None
            for record in solution.starts
        ),
        trace=tuple((n, actuator.goal.shown(f), missed) for n, f, missed in solution.trace),
        algorithm=solution.algorithm,
        models_run_by=actuator.models_run_by,
        warnings=(
            *solution.warnings,
            *(f"variable without effect: {name}" for name in solution.without_effect),
            *_idle(actuator),
            *actuator.refusals.warnings(),
            *follow_up.notes,
        ),
        seed=seed,
        seconds=time.perf_counter() - began,
        certificate=follow_up.certificate,
        rounding=follow_up.rounding,
        choices=choices,
    )


def _idle(actuator: ActuatorProblem) -> tuple[str, ...]:
    """Warnings about objective terms that no variable affects."""
    if actuator.goal.single is not None:
        return ()
    return tuple(
        f"no variable affects {name}, which is part of the objective"
        for name in idle_metrics(actuator)
    )


def _enumerated(
    subject: PreparedDesign,
    choice_search: ChoiceSearch,
    choices: Choices,
    seed: int,
    began: float,
    *,
    certify: bool,
) -> Optimisation:
    """The best combination of choices for a design without variables."""
    best = choice_search.ranked()[0]
    assert best.subject is not None
    status, remedy = "optimal", ""
    if not best.feasible:
        status, remedy = (
            "infeasible",
            'relax the requirement that is missed, or add values in the block "choices:"',
        )
    optimisation = Optimisation(
        status=status,
        sentence=choices.sentence,
        remedy=remedy,
        objective_metric=choice_search.goal.single or "weighted",
        objective_value=choice_search.goal.shown(best.objective),
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
    if not certify:
        return optimisation
    return replace(optimisation, certificate=enumerated(optimisation, choice_search.goal))


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
    quality = solution.kkt
    if quality is None:
        return None
    curvature = "" if quality.curvature is None else quality.curvature.value
    return Kkt(float(quality.residual), quality.active, int(quality.rank), curvature)


_DESIGN, _EVALUATION, _FRACTION, _NUMBER = "$design", "$evaluation", "$fraction", "$number"
_FILE = "$file"
