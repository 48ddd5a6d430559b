"""The governing value of a metric over load cases and places.

Defined here only, for one design and for many: tables, JSON, sweeps, fronts, the optimiser and
reports show this value.
"""

from __future__ import annotations

import numpy as np

from ..base.numeric import Array, maximum, minimum, where
from ..base.quantities import Sense
from .kernel import PreparedDesign
from .limits import MetricArrays, by_case, margin
from .values import Values


def worst_of(aim: Sense) -> Sense:
    """Worst value of a metric: the largest if minimised ("min"), the smallest if maximised.

    >>> worst_of("min")
    'max'
    """
    return "max" if aim == "min" else "min"


def sense_of(metric: str, subject: PreparedDesign) -> Sense | None:
    """Whether the smallest ("min") or the largest value of a metric governs a design.

    1. The worst value of an objective governs: the largest where it is minimised.
    2. A metric with a required limit is governed in the sense of that limit. With limits on both
       sides the sense is None: the value with the smaller margin governs.
    3. Any other metric is governed by its worst value according to `metrics.METRICS`.
    """
    objective = subject.design.objective
    aims = subject.aims or dict.fromkeys(objective.metrics, objective.aim)
    if metric in aims:
        return worst_of(aims[metric])
    required = subject.design.requirements.get(metric)
    if required is None:
        return subject.quantities[metric].worst
    if required.min is not None and required.max is not None:
        return None
    return "max" if required.min is None else "min"


def extreme(
    computed: MetricArrays, metric: str, cases: tuple[str, ...], sense: Sense
) -> Array | None:
    """The smallest or largest value over load cases and places (designs,), SI.

    NaN if any value is missing, None if the metric is not computed.
    """
    pick = maximum if sense == "max" else minimum
    found: Array | None = None
    for place, array in computed.metrics.get(metric, {}).items():
        for _, value in by_case(computed, metric, array, cases, place):
            if found is None:
                found = value
            else:
                unknown = np.isnan(found) | np.isnan(value)
                found = where(unknown, np.nan, pick(found, value))
    return found


def governing(metric: str, computed: MetricArrays, v: Values, subject: PreparedDesign) -> Array:
    """Governing value of a metric for every design (designs,), SI.

    Infinite for an unloaded part; NaN if a value is missing or the metric is not computed.
    """
    sense = sense_of(metric, subject)
    if sense is not None:
        found = extreme(computed, metric, v.cases, sense)
        return np.full(1, np.nan) if found is None else found
    least = extreme(computed, metric, v.cases, "min")
    most = extreme(computed, metric, v.cases, "max")
    if least is None or most is None:
        return np.full(1, np.nan)
    lowest, highest = (v[f"requirements.{metric}.{one}"] for one in ("min", "max"))
    return where(margin(least, lowest, "min") <= margin(most, highest, "max"), least, most)
