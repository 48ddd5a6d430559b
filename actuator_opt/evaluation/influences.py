"""Influence of a design's numbers on its metrics: relative change per relative change.

The influence of a number p on a metric m is e = (dm/m)/(dp/p) at the design, from a complex step of
p [Squire1998]: a change of p by 1 % changes m by e %. All other numbers stay.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from ..base.numeric import STEP
from ..base.quantities import MATERIAL_PROPERTIES, Quantity
from ..design.model import Design
from ..design.paths import quantity_of
from .kernel import PreparedDesign, compute, governing
from .limits import fixed_when_prepared

NO_PERCENT = ("temperature", "temperature_difference", "angle", "count")
"""Dimensions of numbers whose relative change means little: their zero is arbitrary, or they only
take whole values."""

LEAST = 1e-3
"""Smallest influence that is listed."""


def input_quantity(path: str, design: Design) -> Quantity:
    """Quantity of a number of a design or of a material property, by PATH."""
    if path.startswith("materials."):
        return MATERIAL_PROPERTIES[path.rpartition(".")[2]]
    return quantity_of(path, design)


def influential_numbers(subject: PreparedDesign) -> tuple[str, ...]:
    """PATHs of the positive numbers that the models read and that may change by a percentage.

    Numbers that change the knock-downs of strengths are left out: a prepared design keeps these.
    """
    values = subject.values()
    subject.touch(values)
    return tuple(
        path
        for path in sorted(values.read)
        if subject.numbers.get(path, 0.0) > 0
        and not path.startswith("requirements.")
        and not fixed_when_prepared(path)
        and input_quantity(path, subject.design).dimension not in NO_PERCENT
    )


def influences(
    subject: PreparedDesign, metrics: Iterable[str], paths: Sequence[str]
) -> dict[str, dict[str, float]]:
    """Influence of each number on the governing value of each metric, in % per %.

    Parameters
    ----------
    subject : the design
    metrics : names of metrics
    paths : PATHs of positive numbers, such as those of `influential_numbers`

    Returns
    -------
    by metric, the influences of at least `LEAST` by PATH, the largest first; empty for a metric
    that is not computed, zero or infinite
    """
    if not paths:
        return {metric: {} for metric in metrics}
    present = np.array([subject.numbers[path] for path in paths])
    steps = np.repeat(present[:, None].astype(complex), len(paths), axis=1)
    steps += np.diag(1j * STEP * present)
    values = subject.values(dict(zip(paths, steps, strict=True)))
    computed = compute(subject, values).computed
    result = {}
    for metric in metrics:
        value = np.broadcast_to(governing(metric, computed, values, subject), len(paths))
        with np.errstate(all="ignore"):
            slopes = np.nan_to_num(value.imag / STEP / value.real, posinf=0.0, neginf=0.0)
        order = np.argsort(-np.abs(slopes), kind="stable")
        result[metric] = {paths[k]: float(slopes[k]) for k in order if abs(slopes[k]) >= LEAST}
    return result
