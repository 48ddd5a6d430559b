"""The sensitivity table of an actuator: which limits and parameters are priced."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ..base import quantities
from ..base.numeric import STEP
from ..base.quantities import Quantity
from ..base.units import unit
from ..design import quantity_of
from .actuator import ActuatorProblem
from .outcome import Solution
from .prices import prices
from .sensitivity import CHANGE, Sensitivity, ranked

MOST_PARAMETERS = 10
"""Parameters (not limits) priced in the sensitivity table, by importance."""

LEAST_EFFECT = 1e-3
"""Smallest elasticity (% per %) for a row in the table."""

FREE = 1e-9
"""Price of a limit of 0, relative to the objective, below which it gets no row."""

_NO_PERCENT = ("temperature", "temperature_difference", "angle", "count")


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
    numbers = actuator.subject.numbers
    chosen = tuple(path for path in chosen if path in numbers and (numbers[path] or path in active))
    found = prices(actuator.parametric(chosen), solution, change=CHANGE, bounds=False)
    shown = actuator.goal.shown
    rows = []
    for price in found:
        if price.value == 0 and abs(price.price) <= FREE * abs(solution.objective):
            continue
        quantity = _quantity(actuator, price.parameter)
        rows.append(
            Sensitivity(
                parameter=price.parameter,
                label=quantity.label,
                unit=quantity.unit,
                scale=unit(quantity.unit, quantity.dimension).scale if quantity.unit else 1.0,
                limit=price.value,
                price=shown(price.price),
                percent_per_percent=price.percent_per_percent,
                predicted_10=_shown(shown, price.predicted_up),
                resolved_10=_shown(shown, price.resolved_up),
                predicted_minus10=_shown(shown, price.predicted_down),
                resolved_minus10=_shown(shown, price.resolved_down),
                holds_until=price.holds_until,
                next_active=price.change,
                active=price.parameter in active,
                price_up=_finite(shown(price.price_up)),
                price_down=_finite(shown(price.price_down)),
                movement=dict(zip(actuator.paths, price.movement.tolist(), strict=True)),
            )
        )
    return ranked(rows, shown(solution.objective))


def _finite(value: float) -> float | None:
    return value if np.isfinite(value) else None


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
