"""Gains of the controller: stated, or tuned from the linear loop."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import copysign, inf, isfinite, radians

import numpy as np

from ..base.errors import Diagnostic, InputError
from ..base.quantities import INPUTS
from ..design.scenario.model import Control, Scenario
from ..design.scenario.signals import SignalSegment
from ..models.tuning import ControllerGains, margin_rules, ziegler_nichols
from ..studies.plant import Plant
from .assemble import assemble
from .linearise import Law, Linear, Margins, OpenLoop, Ultimate, least, margins
from .loops import LOOPS, Loop, loop_of
from .parts.signals import Records, steady_value

MARGIN = {"p": 2.0, "pi": 3.0}
"""Gain margin of tuning by margins (a choice: a P law gets the design's default, half the ultimate
gain; an integral part costs phase)."""
PHASE = radians(60.0)
"""Phase margin that counts as sufficient (a choice)."""
KEPT = 0.9
"""Share of the proportional loop's margins that must remain with an integral part (a choice)."""
NO_GAIN = 1e-9
"""Replacement factor for a zero gain beside an integral or derivative part."""
UNHELD = "the valve cannot hold the load"
CAUSES = "lower the load or the piston's leakage, raise supply.pressure or the valve's flow"


@dataclass(frozen=True, slots=True)
class Tuned:
    """The controller's gains and their origin."""

    gains: ControllerGains
    origin: str
    ultimate: Ultimate
    margins: Margins
    """Gains in the linear loop, including the scenario's factors."""
    unit: str
    notes: tuple[str, ...] = ()
    unheld: str = ""
    """Where the valve cannot hold the load, else empty. Margins are then meaningless."""


def tune(
    scenario: Scenario, plant: Plant, records: Records, *, held: Tuned | None = None
) -> Tuned | None:
    """Gains of a scenario's controller; None without one. `held` keeps gains, with new margins.

    The linear loop has no sticking friction, and the valve holds the load of the start, whatever
    pressures the scenario begins with. It is evaluated at the start and at every end of the
    reference, for both spool directions; a speed loop also at steady speed. The least ultimate gain
    counts.

    Raises
    ------
    InputError
        a law without a tuning rule; a loop that no gain makes oscillate, or that oscillates open;
        a load that the valve cannot hold
    """
    control, loop = scenario.control, loop_of(scenario.control)
    if control is None or loop is None:
        return None
    circuit = assemble(_held(scenario), plant, records, None, linear=True)
    linear = Linear.of(circuit)
    loops, unheld = _loops(linear, scenario, plant, control, loop)
    limit, worst = least(loops)
    stated = getattr(control, f"{loop}_gain")
    design = plant.design.control
    notes: tuple[str, ...] = ()
    if held is not None:
        gains, origin, notes = held.gains, held.origin, held.notes
    elif stated is not None:
        gains = ControllerGains(
            stated, control.integral_time or inf, control.derivative_time or 0.0
        )
        origin = "stated"
    elif (
        control.tuning == "margins"
        and loop == "position"
        and control.law == "p"
        and design is not None
        and design.gain is not None
        and control.margin is None
    ):
        gains, origin = ControllerGains(design.gain, inf, 0.0), "control.gain of the design"
    elif unheld:
        message = f"{UNHELD}{unheld}, so the gain cannot be tuned"
        remedy = f"{CAUSES}; or state the gain"
        raise InputError(Diagnostic(message, remedy, path=f"control.{loop}"))
    else:
        gains, origin, notes = _ruled(control, loop, limit, worst)
    factor, integral = control.gain_factor or NO_GAIN, control.integral_factor
    shaped = Law(  # each factor scales its own part, as in `parts.control`
        factor * gains.proportional_gain,
        factor / integral * gains.integral_time if integral else inf,
        control.derivative_factor / factor * gains.derivative_time,
        control.filter_time,
    )
    return Tuned(gains, origin, limit, margins(worst, shaped), LOOPS[loop].unit, notes, unheld)


def _held(scenario: Scenario) -> Scenario:
    """The scenario with initial pressures that hold its load."""
    held = scenario.initial.model_copy(update={"pressure_a": None, "pressure_b": None})
    return scenario.model_copy(update={"initial": held})


def _loops(
    linear: Linear, scenario: Scenario, plant: Plant, control: Control, loop: Loop
) -> tuple[list[OpenLoop], str]:
    """Open loops at all relevant points; and where the valve cannot hold the load, in words."""
    if loop != "position":
        loops, held = linear.about()
        end = steady_value(getattr(control, loop))
        if loop != "shaft_angle":
            loops += _running(linear, loop, end)
        return loops, "" if held else " at the start"
    loops, words = [], ""
    for place in _places(control.position, linear.circuit.start.position, plant.stroke):
        found, held = linear.about(position=place)
        loops += found
        if not held:
            words = words or f" with the piston at {INPUTS['position'].text(place)}"
    return loops, words


def _places(parts: Sequence[SignalSegment], start: float, stroke: float) -> list[float]:
    """Start of a position reference, and the end of each of its parts."""
    places, reached = {start}, start
    for part in sorted(parts, key=lambda one: one.start or 0.0):
        reached += steady_value([part])
        places.add(min(max(reached, 0.0), stroke))
    return sorted(places)


def _running(linear: Linear, name: str, value: float) -> list[OpenLoop]:
    """The open loop at a steady speed; empty if the actuator cannot reach it."""
    guess = linear.circuit.centre + copysign(1.0, value)
    found = None if value == 0 else linear.steady(guess, **{name: value})
    return [] if found is None else [linear.loop(*found)]


def _ruled(
    control: Control, loop: Loop, limit: Ultimate, worst: OpenLoop
) -> tuple[ControllerGains, str, tuple[str, ...]]:
    """Gains from the ultimate point by a tuning rule."""
    if worst.swings:
        message = "the open circuit oscillates by itself"
        remedy = "lower speed_feedback and pressure_feedback, or add leakage across the piston"
        raise InputError(Diagnostic(message, remedy, path="control"))
    if not isfinite(limit.gain) or limit.gain <= 0:
        message = "no gain makes the linear loop oscillate, so the gain cannot be tuned"
        raise InputError(Diagnostic(message, "state the gain", path=f"control.{loop}_gain"))
    if control.tuning == "ziegler_nichols":
        gains = ziegler_nichols(
            law=control.law, ultimate_gain=limit.gain, ultimate_period=limit.period
        )
        note = (
            "Ziegler-Nichols ignores friction and leaves little margin on a lightly damped oil "
            "spring: check the overshoot before using the gain"
        )
        return gains, "Ziegler and Nichols", (note,)
    if control.law == "pid":
        message = (
            "tuning by margins supports p or pi, as a derivative part reduces the margins here"
        )
        remedy = "write law: pi, or tuning: ziegler_nichols"
        raise InputError(Diagnostic(message, remedy, path="control.tuning"))
    margin = MARGIN[control.law] if control.margin is None else control.margin
    origin = f"gain margin {margin:g}"
    if loop in ("position", "shaft_angle") or control.law == "p":
        gains = margin_rules(
            law=control.law,
            ultimate_gain=limit.gain,
            velocity_gain=abs(worst.steady_rate) or 1.0,
            gain_margin=margin,
        )
        if control.law == "p":
            return gains, origin, ()
        gain, shortest = gains.proportional_gain, gains.integral_time
    else:
        gain, shortest = limit.gain / margin, 0.02 * limit.period
    time = _integral_time(worst, Law(gain, inf, 0.0, control.filter_time), shortest, limit.period)
    return ControllerGains(gain, time, 0.0), origin, ()


def _integral_time(loop: OpenLoop, law: Law, shortest: float, period: float) -> float:
    """Least integral time from the shortest on that keeps `KEPT` of the margins without it."""
    alone = margins(loop, law)
    phase = PHASE if alone.phase is None else min(KEPT * alone.phase, PHASE)
    longest = 1e4 * period
    for time in np.geomspace(shortest, max(longest, shortest), 140):
        found = margins(loop, replace(law, integral_time=float(time)))
        kept = found.phase is None or found.phase >= phase
        if found.stable and found.gain >= KEPT * alone.gain and kept:
            return float(time)
    return longest
