"""The best value of one limited metric while the objective keeps its present value."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from ..api import Actuator, Session, session
from ..base.errors import InputError, Unsolvable
from ..base.progress import watched
from ..base.quantities import Quantity
from ..evaluation import Evaluation
from ..evaluation.result import Metric
from .worker import Dropped, Stop

DIGITS = 4
"""Digits of the objective's value that is kept: those that the page shows."""


def tradable(start: Evaluation, best: Evaluation) -> list[str]:
    """PATHs of the required limits whose metric can be an objective.

    These are metrics with a value that differs between the start and the optimum of a search.
    """
    design = best.design
    objective = design.objective
    if len(objective.metrics) != 1:
        return []
    return [
        f"requirements.{name}.{sense}"
        for name, limit in design.requirements.items()
        for sense in ("min", "max")
        if getattr(limit, sense) is not None
        and name not in objective.metrics
        and _moves(start, best, name)
    ]


def _moves(start: Evaluation, best: Evaluation, name: str) -> bool:
    before, after = start.metrics[name].value, best.metrics[name].value
    return None not in (before, after) and before != after


class TradeOff:
    """A design whose objective is a metric of a requirement, without that requirement.

    The former objective must be at least as good as it is, rounded to the page's digits.

    Parameters
    ----------
    actuator : the design with the present numbers
    path : PATH of the requirement, such as ``requirements.friction_running.max``
    present : the metric of the design's objective, at its present optimum
    stop : true once the result is no longer wanted
    seed : seed of the search

    Attributes
    ----------
    budget : the value that the former objective must keep, SI
    session : the session of this design

    Raises
    ------
    Unsolvable : the search reaches no design
    Dropped : `stop` became true
    """

    def __init__(
        self, actuator: Actuator, path: str, present: Metric, stop: Stop, seed: int
    ) -> None:
        _, metric, sense = path.split(".")
        name, aim = present.name, actuator.design.objective.aim
        limit = "max" if aim == "min" else "min"
        assert present.value is not None
        self.budget = rounded(present.value, present.quantity, up=aim == "min")
        changes: dict[str, Any] = {
            f"requirements.{metric}": None,
            "objective.minimise" if aim == "min" else "objective.maximise": None,
            "objective.maximise" if sense == "min" else "objective.minimise": metric,
            f"requirements.{name}.{limit}": self.budget,
        }
        kept = {s: getattr(actuator.design.requirements[metric], s) for s in ("min", "max")}
        changes |= {
            f"requirements.{metric}.{s}": value
            for s, value in kept.items()
            if value is not None and s != sense
        }

        def watch(what: str, share: float | None) -> None:
            if stop():
                raise Dropped

        try:
            with watched(watch):
                self.session: Session = session(actuator.changed(changes), seed=seed)
        except InputError as error:
            raise Unsolvable(error.diagnostics[0]) from None

    def curve(
        self, path: str, values: list[float], stop: Stop, *, search: bool
    ) -> Mapping[str, Any]:
        """The best values of the metric for some values of a number; None without a design."""
        curve = self.session.curve(path, values, stop=stop, search=search)
        return {
            "values": curve.values,
            "objectives": curve.objectives,
            "dimensions": [dict(row) for row in curve.variables],
            "budget": self.budget,
        }


def rounded(value: float, quantity: Quantity, *, up: bool) -> float:
    """A value [SI] rounded to `DIGITS` digits of its display unit, upwards or downwards."""
    zero = quantity.to_display(0.0)
    factor, shown = quantity.to_display(1.0) - zero, quantity.to_display(value)
    if shown == 0:
        return value
    step = 10.0 ** (math.floor(math.log10(abs(shown))) + 1 - DIGITS)
    return ((math.ceil if up else math.floor)(shown / step) * step - zero) / factor
