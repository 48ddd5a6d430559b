"""Signals over time as expressions: parts that add up, split where they jump."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from math import pi
from typing import Any

import numpy as np

from ...design.scenario.recorded import Records as Records
from ...design.scenario.recorded import course
from ...design.scenario.signals import Part
from ...numeric import Array, where
from ...symbolic import Expression, Namespace, jacobian
from ..system import System


def signal(system: System, parts: Sequence[Part], records: Records) -> Expression:
    """The sum of the parts at the system's time; zero without parts."""
    total: Expression = 0.0
    for part in parts:
        total = total + _part(system, part, records)
    return total


def _part(system: System, part: Part, records: Records) -> Expression:
    t, start, end = system.time, part.start, part.end
    value: float = getattr(part, "value", None) or 0.0
    if part.shape == "constant":
        return value
    if part.shape == "record":
        known = course(part, records)
        assert known is not None
        time, values = known
        system.bends += _bends(time, values)
        return system.graph.table(_between(time, values), t, _slope(time, values))
    on = system.after(start)
    if part.shape == "step":
        return where(on, value, 0.0)
    if part.shape == "ramp":
        assert end is not None
        done = system.after(end)
        return where(done, value, where(on, value * (t - start) / (end - start), 0.0))
    if end is not None:
        on = on & ~system.after(end) if on is not True else ~system.after(end)
    if part.shape == "pulse":
        return where(on, value, 0.0)
    assert part.frequency is not None
    turn = 2 * pi * part.frequency * (t - start) + part.phase
    return where(on, value * Namespace.sin(turn), 0.0)


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
    """Samples at which the course between samples changes its slope, first and last included."""
    rise, run = np.diff(values, prepend=values[:1], append=values[-1:]), np.diff(time)
    run = np.concatenate(([1.0], run, [1.0]))
    slope = np.divide(rise, run, out=np.full(len(rise), np.inf), where=run > 0)
    found: list[float] = time[slope[1:] != slope[:-1]].tolist()
    return found


def rate(system: System, expression: Expression) -> Expression:
    """Time derivative of a signal between its jumps."""
    return jacobian([expression], [system.time])[0][0]


def steady_value(parts: Sequence[Part]) -> float:
    """What a signal comes to in the end: constants, steps and ramps."""
    kept = ("constant", "step", "ramp")
    return sum(getattr(part, "value", None) or 0.0 for part in parts if part.shape in kept)


def at_start(parts: Sequence[Part], records: Records) -> float:
    """Value of a signal as the time begins; a record that is not given counts as nothing."""
    total = 0.0
    for part in parts:
        value: float = getattr(part, "value", None) or 0.0
        if part.shape == "record":
            known = course(part, records)
            total += 0.0 if known is None else float(np.interp(0.0, *known))
        elif part.shape == "constant" or (part.shape in ("step", "pulse") and part.start <= 0):
            total += value
        elif part.shape == "sine" and part.start <= 0:
            total += value * math.sin(part.phase)
    return total


def acts_after(part: Part, moment: float, records: Records) -> bool:
    """Whether a part of a signal changes after an instant."""
    end = math.inf if part.end is None else part.end
    known = course(part, records)
    if known is not None:
        still = float(np.interp(moment, *known))
        return bool(np.any(known[1][known[0] > moment] != still))
    if part.shape in ("sine", "record"):
        return end > moment
    if part.shape == "ramp" and part.start < moment < end:
        return True
    edges = {"step": (part.start,), "ramp": (part.start, end), "pulse": (part.start, end)}
    return any(moment < edge < math.inf for edge in edges.get(part.shape, ()))


def frequencies(parts: Sequence[Part]) -> tuple[float, ...]:
    """Frequencies of the sines of a signal [Hz]."""
    return tuple(part.frequency for part in parts if part.shape == "sine" and part.frequency)
