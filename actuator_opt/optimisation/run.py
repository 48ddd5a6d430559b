"""Optimise an actuator: problem, solution, prices and, where nothing fits, why."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from .. import quantities
from ..design import quantity_of
from ..evaluation import Subject, evaluate
from ..evaluation.rows import Row
from ..numeric import STEP
from ..quantities import Quantity
from ..units import unit
from . import prices as pricing
from .actuator import ActuatorProblem, Fault, build
from .choice_record import record
from .choice_sizes import Sized, best_of_sizes
from .choices import MOST_SOLVED, Search, Settings, search
from .infeasibility import Infeasibility as Explanation
from .infeasibility import explain
from .outcome import Outcome, Solution
from .result import Choices, Infeasibility, Kkt, Optimisation, Rounding, Sensitivity, VariableResult
from .rounding import Wanted, design_at, rounded, sizes_of
from .solver import solve

MOST_PARAMETERS = 10
"""Parameters (not limits) priced in the sensitivity table: those that matter most."""

LEAST_EFFECT = 1e-3
"""Smallest elasticity (% per %) that earns a parameter its row."""

_NO_PERCENT = ("temperature", "temperature_difference", "angle", "count")


SAMPLES = 2048
"""Points of the global sweep: on every shipped design three seeds of 8192, 2048 and 1024 points led
to one optimum, and where poles and margins are asked the sweep is most of the time."""


def optimise(
    subject: Subject,
    *,
    fault: Fault | None = None,
    algorithm: str = "auto",
    starts: int = 6,
    seed: int = 0,
    prices: bool = True,
    max_seconds: float | None = None,
    whole_plies: bool = False,
    standard_sizes: bool = False,
) -> Optimisation:
    """The best design of a subject.

    Parameters
    ----------
    subject : the prepared design
    fault : places faults of variables in the file
    algorithm : "auto" or an NLopt name such as ``LD_SLSQP``
    starts : starts taken from the global sweep
    seed : of sweep and stochastic algorithms; the same seed gives the same result
    prices : whether to price requirements and parameters (and re-solve at ±10 %)
    max_seconds : time limit of the search; the best design so far is kept
    whole_plies : whether to look for the best design of whole plies and allowed angles too
    standard_sizes : the same, with standard sizes of whatever has some
    """
    began = time.perf_counter()
    until = None if max_seconds is None else began + max_seconds
    wanted = Wanted(whole_plies, standard_sizes)
    sizes = sizes_of(subject.design, wanted, fault)
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
            return _enumerated(subject, found, choices, seed, began)
        actuator, solution = best.actuator, best.solution
    else:
        actuator = build(subject, fault)
        solution = solve(
            actuator.problem,
            algorithm=algorithm,
            starts=starts,
            samples=SAMPLES,
            seed=seed,
            max_seconds=max_seconds,
        )
    rounding: Rounding | None = None
    if sizes is not None and solution.feasible:
        kept = (sizes, None) if sized is None else (sized.sizes, sized.found)
        rounding, solution = rounded(actuator, solution, *kept, until=until, seed=seed)
    why, solution = _explained(actuator, solution)
    design, evaluation = design_at(actuator, solution.x)
    rows: tuple[Sensitivity, ...] = ()
    if prices and solution.outcome is Outcome.OPTIMUM:
        rows = sensitivities(actuator, solution)
    return Optimisation(
        status=solution.outcome.status,
        sentence=solution.outcome.sentence,
        remedy=solution.outcome.remedy,
        objective_metric=actuator.goal.single or "weighted",
        objective_value=actuator.goal.shown(solution.objective),
        design=design,
        evaluation=evaluation,
        start=evaluate(subject),
        variables=_variables(actuator, solution),
        kkt=_kkt(solution),
        sensitivities=rows,
        infeasibility=why,
        evaluations=solution.evaluations,
        samples=solution.samples,
        starts=tuple(actuator.goal.shown(record.objective) for record in solution.starts),
        trace=solution.trace,
        algorithm=solution.algorithm,
        warnings=solution.warnings
        + tuple(f"variable without effect: {name}" for name in solution.without_effect),
        seed=seed,
        seconds=time.perf_counter() - began,
        rounding=rounding,
        choices=choices,
    )


def _enumerated(
    subject: Subject, found: Search, choices: Choices, seed: int, began: float
) -> Optimisation:
    """The best combination of the choices, where nothing else may move."""
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


def sensitivities(actuator: ActuatorProblem, solution: Solution) -> tuple[Sensitivity, ...]:
    """Price every limit that could bind and the parameters that matter most."""
    active = _active_limits(actuator, solution)
    limits = dict.fromkeys(
        row.limit_of.path
        for row in actuator.rows
        if row.limit_of.path is not None
        and (row.limit_of.origin in ("requirement", "case") or row.limit_of.path in active)
    )
    chosen = (*limits, *_strongest(actuator, solution, set(limits)))
    chosen = tuple(path for path in chosen if actuator.subject.numbers.get(path))
    found = pricing.prices(actuator.parametric(chosen), solution, bounds=False)
    shown = actuator.goal.shown
    rows = []
    for price in found:
        quantity = _quantity(actuator, price.parameter)
        rows.append(
            Sensitivity(
                parameter=price.parameter,
                label=quantity.label,
                unit=quantity.unit,
                scale=unit(quantity.unit, quantity.dimension).scale if quantity.unit else 1.0,
                limit=price.value,
                price=shown(price.price),
                percent_per_percent=price.percent_per_percent or 0.0,
                predicted_10=_shown(shown, price.predicted_up),
                resolved_10=_shown(shown, price.resolved_up),
                predicted_minus10=_shown(shown, price.predicted_down),
                resolved_minus10=_shown(shown, price.resolved_down),
                holds_until=price.holds_until,
                next_active=price.change,
                active=price.parameter in active,
            )
        )
    rows.sort(key=lambda row: -abs(row.percent_per_percent))
    return tuple(rows)


def _shown(shown: Callable[[float], float], value: float | None) -> float | None:
    return None if value is None else shown(value)


def _active_limits(actuator: ActuatorProblem, solution: Solution) -> set[str]:
    labels = set(solution.kkt.active) if solution.kkt is not None else set()
    return {
        row.limit_of.path
        for row in actuator.rows
        if row.label in labels and row.limit_of.path is not None
    }


def _quantity(actuator: ActuatorProblem, path: str) -> Quantity:
    if path.startswith("requirements."):
        return actuator.subject.quantities[path.split(".")[1]]
    if path.startswith("materials."):
        return quantities.MATERIAL_PROPERTIES[path.rpartition(".")[2]]
    return quantity_of(path, actuator.subject.design)


def _strongest(actuator: ActuatorProblem, solution: Solution, known: set[str]) -> tuple[str, ...]:
    """The parameters with the largest elasticity of the objective, by the Lagrangian."""
    if solution.kkt is None:
        return ()
    numbers = actuator.subject.values(
        {path: np.array([x]) for path, x in zip(actuator.paths, solution.x, strict=True)}
    )
    actuator.subject.touch(numbers)
    candidates = [
        path
        for path in sorted(numbers.read)
        if path not in known
        and path not in actuator.paths
        and actuator.subject.numbers.get(path, 0.0) > 0
        and not path.startswith("requirements.")
        and _quantity(actuator, path).dimension not in _NO_PERCENT
    ]
    if not candidates:
        return ()
    present = np.array([actuator.subject.numbers[path] for path in candidates])
    varied = np.repeat(present[:, None].astype(complex), len(candidates), axis=1)
    varied += np.diag(1j * STEP * present)
    points = np.repeat(solution.x[:, None], len(candidates), axis=1)
    values = actuator.evaluate(points, dict(zip(candidates, varied, strict=True)))
    slope = np.imag(values.objective) - solution.kkt.multipliers @ np.imag(values.constraints)
    elasticity = np.nan_to_num(slope / STEP / abs(solution.objective or 1.0))
    order = np.argsort(-np.abs(elasticity), kind="stable")
    return tuple(
        candidates[i] for i in order[:MOST_PARAMETERS] if abs(elasticity[i]) >= LEAST_EFFECT
    )


def _explained(
    actuator: ActuatorProblem, solution: Solution
) -> tuple[Infeasibility | None, Solution]:
    """Why nothing fits, and the design that needs only the smallest joint relaxation."""
    if solution.feasible or solution.kkt is None:
        return None, solution
    points = [found.x for found in solution.optima] or [solution.x]
    found = explain(actuator.problem, points)
    objective = float(np.ravel(actuator.evaluate(found.x[:, None]).objective)[0])
    closest = replace(solution, x=found.x, objective=objective, kkt=None)
    return _card(actuator, found), closest


def _card(actuator: ActuatorProblem, found: Explanation) -> Infeasibility:

    def entry(index: int, amount: float | None) -> dict[str, Any]:
        row = actuator.rows[index]
        limit = float(np.ravel(row.limit)[0])
        return {
            "requirement": row.limit_of.name,
            "parameter": row.limit_of.path,
            "metric": row.limit_of.metric,
            "sense": row.limit_of.sense,
            "limit": limit,
            "needed": None if amount is None else _relaxed(row, limit, amount),
            "relaxation": amount,
        }

    sole = [entry(r.index, r.amount) for r in found.sole]
    named = {r.index for r in found.joint}
    return Infeasibility(
        joint=tuple(entry(r.index, r.amount) for r in found.joint),
        sole=tuple(
            item
            for item, r in zip(sole, found.sole, strict=True)
            if r.amount is not None or r.index in named
        ),
        bounds=tuple(
            {
                "variable": b.variable,
                "quantity": quantity_of(b.variable, actuator.subject.design).name,
                "bound": b.side,
                "value": b.value,
                "gain": b.gain,
            }
            for b in found.bounds
        ),
        laws=found.laws,
    )


def _relaxed(row: Row, limit: float, amount: float) -> float:
    """The limit that would do after giving up a margin `amount`."""
    step = amount * (abs(limit) or 1.0)
    return limit - step if row.limit_of.sense == "min" else limit + step
