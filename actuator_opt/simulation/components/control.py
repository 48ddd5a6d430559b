"""The controller: P, PI or PID on the error, inner loops, limits of value and rate."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf

from ...base.numeric import clip, where
from ...base.symbolic import Expression
from .circuit import Circuit

HOLD_BAND = 1e-3
"""Share of the full signal over which the integral part stops before the limit (a choice: the
integral is frozen while the signal is saturated and the error would increase it)."""
RATE_TIME = 1e-4
"""Time lag of a rate-limited signal [s] (a choice)."""


@dataclass(frozen=True, slots=True)
class Feedback:
    """Feedback signals of the controller."""

    value: Expression
    """Measured value of the loop: position, speed, shaft speed or angle."""
    speed: Expression
    load_pressure: Expression
    """Load pressure: pressure force over area A [Pa]."""
    load_pressure_start: float = 0.0


def inner(circuit: Circuit, wish: Expression, measured: Feedback) -> Expression:
    """A reference less the inner loops: speed, and changes of the load pressure."""
    system, stated = circuit.system, circuit.scenario.control
    if stated is None:
        return wish
    wish = wish - stated.speed_feedback * measured.speed
    if stated.pressure_feedback:
        start = measured.load_pressure_start
        slow = system.state("filtered load pressure", start, tolerance=1.0)
        system.rate(slow, (measured.load_pressure - slow) / stated.pressure_time)
        wish = wish - stated.pressure_feedback * (measured.load_pressure - slow)
    return wish


def command(
    circuit: Circuit, reference: Expression, measured: Feedback, scale: float
) -> Expression:
    """Signal to the valve; `scale` is a typical control error, for tolerances."""
    system, stated, gains = circuit.system, circuit.scenario.control, circuit.gains
    assert stated is not None
    assert gains is not None
    assert circuit.plant.valve is not None
    full_signal = circuit.plant.valve.signal
    gain = stated.gain_factor * gains.proportional_gain
    error = reference - measured.value
    wish: Expression = gain * error
    if gains.derivative_time > 0:
        slow = system.state("filtered error", 0.0, tolerance=1e-9 * scale)
        change = (error - slow) / stated.filter_time
        system.rate(slow, change)
        factor = stated.derivative_factor * gains.proportional_gain
        wish = wish + factor * gains.derivative_time * change
    wish = inner(circuit, wish, measured)
    if gains.integral_time < inf:
        part = system.state("integral part", 0.0, tolerance=1e-7 * full_signal)
        wish = wish + part
        band = HOLD_BAND * full_signal
        up = clip((full_signal - wish) / band, 0.0, 1.0)
        down = clip((full_signal + wish) / band, 0.0, 1.0)
        factor = stated.integral_factor * gains.proportional_gain
        rate = factor / gains.integral_time * error
        system.rate(part, where(rate > 0, rate * up, rate * down))
    wish = clip(wish, -full_signal, full_signal)
    if stated.rate_limit is None:
        return wish
    limited = system.state("limited signal", 0.0, tolerance=1e-7 * full_signal)
    system.rate(limited, clip((wish - limited) / RATE_TIME, -stated.rate_limit, stated.rate_limit))
    return limited
