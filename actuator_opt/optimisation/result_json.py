"""The JSON object of an optimisation (SI): the evaluation's keys and the optimiser's."""

from __future__ import annotations

from dataclasses import asdict
from math import isfinite
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .result import Optimisation


def of_optimisation(found: Optimisation) -> dict[str, Any]:
    """The object of `optimise --json`.

    Metrics, requirements, checks, objective and variables are those of the design to build, as
    `evaluate` of the saved file repeats them; multipliers, prices and certificate those of the
    continuous optimum.
    """
    best, value = found.best_evaluation, found.best_objective
    why = found.infeasibility
    return (
        best.to_dict()
        | {
            "status": found.status,
            "outcome": found.sentence,
            "remedy": found.remedy,
            "shown": _shown(found),
            "warnings": [*best.warnings, *found.warnings],
            "objective": {
                "metric": found.objective_metric,
                "value": value if isfinite(value) else None,
            },
            "variables": _variables(found),
            "kkt": None if found.kkt is None else asdict(found.kkt),
            "sensitivities": [row.to_dict(found.objective_value) for row in found.sensitivities],
            "what_buys_most": found.offers.to_dict() | {"sentence": " ".join(found.buys_most)},
            "certificate": None if found.certificate is None else found.certificate.to_dict(),
            "rounding": _rounding(found),
            "choices": None if found.choices is None else found.choices.to_dict(),
            "evaluations": found.evaluations,
            "algorithm": found.algorithm,
            "seed": found.seed,
            "seconds": found.seconds,
        }
        | ({} if why is None else {"infeasibility": asdict(why)})
        | ({} if found.robust is None else {"robust": found.robust.to_dict()})
    )


def _shown(found: Optimisation) -> dict[str, Any]:
    """Which design the object is of: the continuous optimum, or that of the sizes asked for."""
    return {
        "design": "continuous" if found.made is None else "rounded",
        "sizes": None if found.rounding is None else found.rounding.name,
        "sentence": found.shown,
    }


def _variables(found: Optimisation) -> dict[str, Any]:
    """Value, bounds and the bound it is at of every variable, by PATH."""
    kept = ("value", "lower", "upper", "at_bound")
    return {v.path: {name: getattr(v, name) for name in kept} for v in found.best_variables}


def _rounding(found: Optimisation) -> dict[str, Any] | None:
    """The rounding with the evaluation of the optimum it began from."""
    if found.rounding is None:
        return None
    return found.rounding.to_dict() | {"continuous_evaluation": found.evaluation.to_dict()}
