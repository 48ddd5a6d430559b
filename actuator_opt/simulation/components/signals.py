"""Signals over time as expressions: sums of parts, split where they jump."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ...base.numeric import Array
from ...base.symbolic import Expression, Namespace, jacobian
from ...design.scenario.kinds import SHAPES, Records as Records, height
from ...design.scenario.signals import SignalSegment
from ..system import System


@dataclass(frozen=True, slots=True)
class _Clock:
    """The time of a system (`shapes.Clock`)."""

    system: System

    @property
    def time(self) -> Expression:
        return self.system.time

    def after(self, instant: float) -> Any:
        return self.system.after(instant)

    def sine(self, angle: Expression) -> Expression:
        return Namespace.sin(angle)

    def samples(self, time: Array, values: Array) -> Expression:
        self.system.bends += _bends(time, values)
        course, slope = _between(time, values), _slope(time, values)
        return self.system.graph.table(course, self.time, slope)


def signal(system: System, parts: Sequence[SignalSegment], records: Records) -> Expression:
    """The sum of the parts at the system's time; zero without parts."""
    total: Expression = 0.0
    for part in parts:
        total = total + SHAPES[part.shape].course(_Clock(system), part, records)
    return total


def _between(time: Array, values: Array) -> Callable[[Any], Any]:
    """Linear between samples, constant outside."""

    def at(moment: Any) -> Any:
        found = np.interp(moment, time, values)
        return float(found) if np.ndim(found) == 0 else found

    return at


def _slope(time: Array, values: Array) -> Callable[[Any], Any]:
    """Slope between samples, zero outside."""
    run = np.diff(time)
    rise = np.divide(np.diff(values), run, out=np.zeros(len(run)), where=run > 0)
    steps = np.concatenate(([0.0], rise, [0.0]))

    def at(moment: Any) -> Any:
        found = steps[np.searchsorted(time, moment, side="right")]
        return float(found) if np.ndim(found) == 0 else found

    return at


def _bends(time: Array, values: Array) -> list[float]:
    """Samples at which the slope changes, first and last included."""
    rise, run = np.diff(values, prepend=values[:1], append=values[-1:]), np.diff(time)
    run = np.concatenate(([1.0], run, [1.0]))
    slope = np.divide(rise, run, out=np.full(len(rise), np.inf), where=run > 0)
    found: list[float] = time[slope[1:] != slope[:-1]].tolist()
    return found


def rate(system: System, expression: Expression) -> Expression:
    """Time derivative of a signal between its jumps."""
    return jacobian([expression], [system.time])[0][0]


def steady_value(parts: Sequence[SignalSegment]) -> float:
    """Final value of a signal: the parts that persist."""
    return sum(height(part) for part in parts if SHAPES[part.shape].lasts)


def at_start(parts: Sequence[SignalSegment], records: Records) -> float:
    """Value of a signal at time zero; a missing record counts as zero."""
    return sum(SHAPES[part.shape].initial(part, records) for part in parts)


def acts_after(part: SignalSegment, moment: float, records: Records) -> bool:
    """Whether a part of a signal changes after an instant."""
    return SHAPES[part.shape].changes_after(part, moment, records)


def frequencies(parts: Sequence[SignalSegment]) -> tuple[float, ...]:
    """Frequencies of the sines of a signal [Hz]."""
    return tuple(
        part.frequency
        for part in parts
        if part.frequency and "frequency" in SHAPES[part.shape].needed
    )
