"""The duty cycles of a design over time, with its temperatures from cold."""

from __future__ import annotations

from dataclasses import fields, is_dataclass, replace
from typing import Any

import numpy as np

from ..base.numeric import real
from .duty_cycles import thermal
from .duty_cycles.numbers import stacked_numbers
from .duty_cycles.study import DutyStudy, study as study_of_cycles
from .duty_cycles.warming import warmings
from .kernel import ModelRun, PreparedDesign, cycle_models, sample_numbers, statics
from .limits import MetricArrays
from .values import Values


def study(subject: PreparedDesign, v: Values, run: ModelRun) -> DutyStudy | None:
    """The duty cycles of a single design; None if it states none."""
    design = subject.design
    if design.duty is None:
        return None
    with np.errstate(all="ignore"):
        s = statics(subject, v, MetricArrays())
        plan, named = sample_numbers(subject, v, s)
        models, numbers = cycle_models(subject, plan, named), stacked_numbers(named)
        widths = run.computed.metrics.get("contact_width", {})
        duty = study_of_cycles(
            models, numbers[:, 0], {seal: float(np.max(width)) for seal, width in widths.items()}
        )
        results = dict(zip(models.places, models(numbers)[:, 0].tolist(), strict=True))
        tank = run.computed.metrics.get("duty_tank_temperature", {}).get("")
        stock, g = s.base.stock, s.base.geometry
        states = dict(thermal.states(v, design, stock, g, results, tank))
        values = dict(zip(models.names, numbers[:, 0].tolist(), strict=True))
        warming = warmings(
            design, stock, {name: _single(x) for name, x in states.items()}, duty.cycles, values
        )
        return replace(duty, warming=tuple(warming))


def _single(value: Any) -> Any:
    """The state of a single design with floats instead of arrays of one value."""
    if value is None:
        return None
    if is_dataclass(value) and not isinstance(value, type):
        parts = {field.name: _single(getattr(value, field.name)) for field in fields(value)}
        return replace(value, **parts)
    if isinstance(value, dict):
        return {key: _single(part) for key, part in value.items()}
    if isinstance(value, tuple):
        made = [_single(part) for part in value]
        return type(value)(*made) if hasattr(value, "_fields") else tuple(made)
    return float(np.ravel(real(np.asarray(value)))[0])
