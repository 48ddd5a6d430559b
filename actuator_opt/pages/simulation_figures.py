"""Figures of a simulation as ink: strips over time, and the panels that its kind of run has."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..base.fitting import NORMAL
from ..base.numeric import Array
from ..base.quantities import INPUTS, RESULTS, SCENARIOS, Quantity
from ..models.fluid import ATMOSPHERIC_PRESSURE
from ..rendering.axes import (
    SIZE,
    ZERO,
    Axes,
    Box,
    band,
    error_bar,
    even_ticks,
    lines,
    names,
    required,
    steady_range,
    thinned,
    time_axis,
    x_axis,
)
from ..rendering.ink import BLACK, BLUE, OCHRE, WHITE, Ink, text_width
from ..rendering.strips import (
    ASKED,
    LEVEL,
    LIMIT,
    MEASURED,
    STYLES,
    ConstantLevel,
    Strip,
    StripCurve,
    stack,
)
from ..rendering.text import SENSES, number, trimmed, unit_text
from ..simulation.components.circuit import LOOPS, Loop, loop_of
from ..simulation.harmonic import harmonic_fit
from ..simulation.linear import BAND
from ..simulation.result import HarmonicLoad, Servo, Simulation, Window
from .simulation_energy import ROW, TOP, over_time, share_panel, shares, time_panel

WIDTH = 180.0
LEAST, MOST = 92.0, 150.0
"""Heights of the whole figure [mm]."""
LEFT, STRIPS, GAP = 11.0, 83.0, 8.0
"""Room for numbers beside the strips, their width, and from there to the panels [mm]."""
LEAST_PANEL = 26.0
"""Least height of a panel [mm]."""
MOST_MARKS = 8
"""Events that are marked in the strips."""
LAG = 0.02
"""Distance of the spool from its signal, over the largest signal, within which a flow belongs to
the signal (a choice)."""
FLOWS = (("flow_a", "A"), ("flow_b", "B"), ("flow_supply", "supply"), ("flow_tank", "tank"))
Measured = Mapping[str, tuple[Array, Array]]
"""Time [s] and values (SI) by the name of the signal."""
_SIGNALS: tuple[tuple[str, int, bool, tuple[tuple[str, str], ...]], ...] = (
    ("Speed", 6, True, (("speed", ""),)),
    ("Shaft speed", 1, True, (("shaft_speed", ""),)),
    ("Shaft angle", 5, False, (("shaft_angle", ""),)),
    ("Joint angle", 7, False, (("joint_angle", ""),)),
    ("Valve signal", 3, True, (("signal", "signal"), ("spool", "spool"))),
    ("Pressures", 2, False, (("pressure_a", "A"), ("pressure_b", "B"))),
    (
        "Supply",
        7,
        False,
        (("pressure_supply", "supply"), ("pressure_accumulator", "accumulator")),
    ),
    ("Flows into the ports", 4, True, (("flow_a", "A"), ("flow_b", "B"))),
    ("Flows of the line", 4, True, (("flow_supply", "from supply"), ("flow_tank", "to tank"))),
    ("Flows of the pump", 7, True, (("flow_pump", "pump"), ("flow_relief", "relief"))),
    ("Flows past the throttles", 5, True, (("flow_throttle_a", "out of A"),
                                           ("flow_throttle_b", "out of B"))),
    ("Friction", 5, True, (("friction", ""),)),
    ("Load", 6, True, (("load_force", ""),)),
    ("Torques", 4, True, (("torque", "motor"), ("load_torque", "load"))),
    ("Torque on the joint", 8, True, (("joint_torque", ""),)),
    ("Stops and cushions", 5, True, (("stop_force", "stops"), ("cushion_force", "cushions"))),
)  # fmt: skip
"""Title, rank, whether zero belongs to it, and signals with their names."""
_STILL = {"Stops and cushions", "Load", "Supply", "Torque on the joint", "Friction"}
"""Strips that are left out while none of their signals moves."""
_PUMPED = ("Supply", "Flows of the pump")
"""Strips that come early where the supply pressure varies."""
LEAST_SHOWN = 0.01
"""Overshoot from which on it is marked, share of the step: less is in the width of the band."""
ROOM = 4.6
"""Room of a line of words beyond the peak [mm]."""
_BAND = "#e8eef2"
_MARK = {"stroke": OCHRE, "pen": 0.18}
PRESSURE = INPUTS["pressure"]
STIFFNESS, PHASE = RESULTS["dynamic_stiffness"], RESULTS["dynamic_phase"]
MOVED = 0.02
"""Share of the stroke over which windows must spread to be shown along it (a choice)."""
MOST_WINDOWS = 40
"""Windows that are shown as marks with bars; more become a line with a band."""
CYCLES = 3
"""Cycles of the loop that are drawn."""
Static = tuple[Array, Array]
"""Positions [m] and static stiffness there [N/m]."""
Limits = Sequence[tuple[str, float]]
"""Senses and limits (SI)."""
Series = tuple[list[float], list[float], list[float], dict[str, Any]]


# ---- the whole figure ----


@dataclass(frozen=True, slots=True)
class FigurePanel:
    """A figure that fills a box: a fixed height, or a weight in what is left [mm]."""

    name: str
    draw: Callable[[Ink, Box], None]
    height: float = 0.0
    weight: float = 1.0
    least: float = LEAST_PANEL


def panels(simulation: Simulation, measured: Measured, static: Static | None) -> list[FigurePanel]:
    """The panels of this run beside its strips, the most important first."""
    made = []
    if simulation.servo is not None:
        made.append(
            FigurePanel(
                "step", lambda ink, box: step_panel(ink, box, simulation, measured), 0.0, 1.5, 44.0
            )
        )
    if simulation.shaken is not None and simulation.shaken.windows:
        made.append(
            FigurePanel(
                "stiffness",
                lambda ink, box: _stiffness(ink, box, simulation, static),
                0.0,
                1.6,
                40.0,
            )
        )
        made.append(FigurePanel("cycles", lambda ink, box: loop_panel(ink, box, simulation)))
    if simulation.scenario.held_ports is not None and np.ptp(simulation.signals["signal"]) > 0:
        made.append(
            FigurePanel("flows", lambda ink, box: _flows(ink, box, simulation), 0.0, 1.4, 40.0)
        )
    count = len(shares(simulation))
    if count:
        made.append(
            FigurePanel(
                "energy",
                lambda ink, box: share_panel(ink, box, simulation),
                TOP + ROW * count + 1.0,
            )
        )
    curves = over_time(simulation)
    if len(curves) > 1:
        made.append(
            FigurePanel(
                "energy_time", lambda ink, box: time_panel(ink, box, simulation, curves), weight=0.9
            )
        )
    if "friction" in simulation.signals and np.ptp(simulation.signals["speed"]) > 0:
        made.append(
            FigurePanel(
                "friction", lambda ink, box: _friction(ink, box, simulation), 0.0, 0.9, 38.0
            )
        )
    return made


def simulation_figure(
    simulation: Simulation,
    height: float = MOST,
    *,
    measured: Measured | None = None,
    static: Static | None = None,
) -> Ink:
    """Strips over time at the left, the panels of this run at the right, in one drawing."""
    height = min(max(height, LEAST), MOST)
    ink = Ink(WIDTH, height)
    known = measured or {}
    right = _chosen(panels(simulation, known, static), height)
    shown = strips(simulation, known)
    wide = STRIPS if right else WIDTH - LEFT - 2.0
    stack(ink, (LEFT, 0.0, wide, height), shown, (0.0, _end(simulation)), marks=_marks(simulation))
    if not right:
        return ink
    left = LEFT + STRIPS + GAP
    fixed = sum(panel.height for panel in right)
    weights = sum(panel.weight for panel in right if not panel.height)
    gaps = 2.0 * (len(right) - 1)
    share = (height - fixed - gaps) / weights if weights else 0.0
    y = 0.0
    for panel in right:
        tall = panel.height or min(share * panel.weight, 70.0 * panel.weight)
        panel.draw(ink, (left, y, WIDTH - left, tall))
        y += tall + 2.0
    return ink


def _chosen(made: list[FigurePanel], height: float) -> list[FigurePanel]:
    """The first panels that have room; a later one may fill what a larger one leaves."""
    chosen: list[FigurePanel] = []
    used = 0.0
    for panel in made:
        need = panel.height or panel.least
        if chosen and used + need > height:
            continue
        chosen.append(panel)
        used += need + 2.0
    return chosen


def _end(simulation: Simulation) -> float:
    return float(simulation.time[-1])


def _marks(simulation: Simulation) -> list[float]:
    """Instants of the first events."""
    return [event.time for event in simulation.events[:MOST_MARKS]]


# ---- panels of single kinds of run ----


def _stiffness(ink: Ink, box: Box, simulation: Simulation, static: Static | None) -> None:
    """Size above phase, along the stroke or over time."""
    shaken = simulation.shaken
    assert shaken is not None
    left, top, width, height = box
    over = "stroke" if travelled(shaken.windows, simulation.plant.stroke) else "time"
    profile = along("", shaken, over, STYLES[0])
    limits = (limits_of(simulation, "dynamic_stiffness"), limits_of(simulation, "dynamic_phase"))
    upper = 0.56 * height
    boxes = ((left, top, width, upper), (left, top + upper, width, height - upper))
    side = 12.0 if any(limits) else 3.0
    stiffness_panels(ink, boxes, [profile], over, static=static, limits=limits, side=side)


def _friction(ink: Ink, box: Box, simulation: Simulation) -> None:
    """Friction over speed during the run."""
    left, top, width, height = box
    force, speed = (simulation.told[name].quantity for name in ("friction", "speed"))
    xs, ys = (
        scaled(simulation.told[n].quantity, simulation.signals[n]) for n in ("speed", "friction")
    )
    frame = (left + 11.0, top + 6.5, width - 14.0, height - 14.0)
    ranges = [steady_range([float(np.min(v)), float(np.max(v))], zero=True) for v in (xs, ys)]
    axes = Axes(ink, frame, ranges[0], ranges[1])
    axes.frame_at("", "", [], even_ticks(*ranges[1], 4))
    ink.text(left, top + 2.0, titled("Friction over speed", force), size=7.0, bold=True)
    _cross(axes)
    at = np.union1d(thinned(xs, 2000), thinned(ys, 2000))
    points = ([float(v) for v in column[at]] for column in (xs, ys))
    ink.path(axes.clipped(*points), stroke=BLUE, pen=0.2)
    x_axis(axes, titled("speed", speed))


def _cross(axes: Axes) -> None:
    """Lines at zero, where it lies inside."""
    (left, right), (low, high) = axes.x_range, axes.y_range
    if left < 0 < right:
        axes.ink.line((axes.x(0.0), axes.y(low)), (axes.x(0.0), axes.y(high)), **ZERO)
    if low < 0 < high:
        axes.ink.line((axes.x(left), axes.y(0.0)), (axes.x(right), axes.y(0.0)), **ZERO)


def _flows(ink: Ink, box: Box, simulation: Simulation) -> None:
    """Flows of a valve over its signal, at samples where the spool follows the signal."""
    left, top, width, height = box
    quantity, volts = simulation.told["flow_a"].quantity, SCENARIOS["signal_value"]
    signal = scaled(volts, simulation.signals["signal"])
    lag = np.abs(scaled(volts, simulation.signals["spool"]) - signal)
    there = lag <= LAG * float(np.max(np.abs(signal)))
    if np.count_nonzero(there) < 0.5 * there.size:
        there[:] = True
    entries = [
        (words, scaled(quantity, simulation.signals[name])[there], style)
        for (name, words), style in zip(FLOWS, STYLES, strict=True)
    ]
    signal = signal[there]
    frame = (left + 11.0, top + 6.5, width - 14.0, height - 14.0)
    across = steady_range([float(np.min(signal)), float(np.max(signal))])
    ends = [float(v) for _, values, _ in entries for v in (np.min(values), np.max(values))]
    axes = Axes(ink, frame, across, steady_range(ends, zero=True))
    axes.frame_at("", "", [], even_ticks(*axes.y_range, 6))
    title = titled("Flows over signal", quantity)
    ink.text(left, top + 2.0, title, size=7.0, bold=True)
    _cross(axes)
    for _, values, style in entries:
        at = thinned(values)
        xs, ys = ([float(v) for v in column[at]] for column in (signal, values))
        ink.path(axes.clipped(xs, ys), **style | {"pen": 0.35})
    room = width - text_width(title, 7.0, bold=True) - 2.0
    names(ink, left + width, top + 2.0, [(words, style) for words, _, style in entries], room)
    x_axis(axes, f"signal, {unit_text(volts.unit)}")


# ---- strips over time ----


def scaled(quantity: Quantity, values: Array) -> Array:
    """Values in the unit shown."""
    return np.asarray(values, dtype=float) * quantity.to_display(1.0)


def curve(simulation: Simulation, name: str, words: str, style: dict[str, Any]) -> StripCurve:
    """A signal as a curve."""
    return StripCurve(
        words,
        simulation.time,
        scaled(simulation.told[name].quantity, simulation.signals[name]),
        style,
    )


def overlay(simulation: Simulation, name: str, measured: Measured) -> list[StripCurve]:
    """The measured values of a signal, drawn under it."""
    if name not in measured or name not in simulation.told:
        return []
    time, values = measured[name]
    shown = scaled(simulation.told[name].quantity, values)
    return [StripCurve("measured", np.asarray(time, dtype=float), shown, MEASURED)]


def titled(words: str, quantity: Quantity) -> str:
    """A title with its unit.

    >>> from actuator_opt.base.quantities import SCENARIOS
    >>> titled("Speed", SCENARIOS["speed_value"]), titled("Ratio", SCENARIOS["factor"])
    ('Speed, m/s', 'Ratio')
    """
    unit = unit_text(quantity.unit)
    return f"{words}, {unit}" if unit else words


def followed(simulation: Simulation) -> Loop | None:
    """The signal that a controller follows, else the one that moves; None where nothing moves."""
    control = simulation.scenario.control
    if control is not None and "reference" in simulation.signals:
        return loop_of(control)
    return next((name for name in ("position", "shaft_speed") if name in simulation.signals), None)


def response(simulation: Simulation, measured: Measured) -> Strip | None:
    """The moving signal with its reference and its record; None where nothing moves."""
    name = followed(simulation)
    if not name:
        return None
    words, quantity, *_ = LOOPS[name]
    curves = overlay(simulation, name, measured)
    asked = "reference" if "reference" in simulation.signals else "drive_position"
    if asked in simulation.signals:
        curves.append(
            curve(simulation, asked, "asked" if asked == "reference" else "machine", ASKED)
        )
    own = "response" if curves else ""
    curves.append(curve(simulation, name, own, STYLES[0]))
    return Strip(titled(words.capitalize(), quantity), tuple(curves), rank=0)


def strips(simulation: Simulation, measured: Measured) -> list[Strip]:
    """The strips of a run, the response first."""
    shown = []
    first = response(simulation, measured)
    if first is not None:
        shown.append(first)
    if "error" in simulation.signals:
        quantity = simulation.told["error"].quantity
        own = curve(simulation, "error", "", STYLES[0])
        shown.append(Strip(titled("Error", quantity), (own,), zero=True, rank=3))
    used = followed(simulation)
    if used not in (None, "position") and "position" in simulation.signals:
        shown += _strip(simulation, measured, "Position", 5, False, (("position", ""),))
    pumped = simulation.scenario.supply.type != "constant"
    for title, rank, zero, signals in _SIGNALS:
        if used not in [name for name, _ in signals]:
            early = 3 if pumped and title in _PUMPED else rank
            shown += _strip(simulation, measured, title, early, zero, signals)
    return shown


def _strip(
    simulation: Simulation,
    measured: Measured,
    title: str,
    rank: int,
    zero: bool,
    signals: Sequence[tuple[str, str]],
) -> list[Strip]:
    here = [(name, words) for name, words in signals if name in simulation.signals]
    if title == "Flows of the line" and simulation.scenario.held_ports is None:
        return []
    if title in _STILL and not any(_moves(simulation.signals[name]) for name, _ in here):
        return []
    if not here:
        return []
    under = [
        measured_curve for name, _ in here for measured_curve in overlay(simulation, name, measured)
    ]
    over = [
        curve(simulation, name, words if len(here) > 1 else "", style)
        for (name, words), style in zip(here, STYLES, strict=False)
    ]
    if under and len(over) == 1:
        over = [curve(simulation, here[0][0], "simulated", STYLES[0])]
    quantity = simulation.told[here[0][0]].quantity
    levels, zero = _levels(simulation, here[0][0], zero)
    return [Strip(titled(title, quantity), (*under, *over), levels, zero, rank)]


def _moves(values: Array) -> bool:
    return float(np.ptp(values)) > 1e-9 * max(float(np.max(np.abs(values))), 1e-12)


def _levels(
    simulation: Simulation, name: str, zero: bool
) -> tuple[tuple[ConstantLevel, ...], bool]:
    """Levels of a strip, and whether its axis includes them."""
    scale = PRESSURE.to_display(1.0)
    if name == "pressure_a":
        plant = simulation.plant
        vapour = ConstantLevel(
            "vapour", scale * (plant.oil.vapour_pressure - ATMOSPHERIC_PRESSURE), LIMIT
        )
        supplied = simulation.signals.get("pressure_supply")
        if supplied is None:
            return (vapour,), False
        pressures = [plant.return_pressure] + ([] if _moves(supplied) else [plant.supply_pressure])
        words = "supply, return" if len(pressures) > 1 else "return"
        return (*(ConstantLevel(words, scale * p, LEVEL) for p in pressures), vapour), True
    if name == "signal" and simulation.plant.valve is not None:
        full = simulation.plant.valve.signal
        if float(np.max(np.abs(simulation.signals[name]))) > 0.5 * full:
            return tuple(ConstantLevel("limit", way * full, LEVEL) for way in (1, -1)), True
    return (), zero


# ---- the step of a servo: rise, overshoot and settling where they are read ----


def end_of(simulation: Simulation, servo: Servo) -> float:
    """The time at which the reference changes again, or the run ends [s]."""
    asked = simulation.signals["reference"]
    size = abs(servo.target - servo.start)
    later = (simulation.time > servo.time) & (np.abs(asked - servo.target) > 1e-9 * size)
    return float(simulation.time[later][0]) if np.any(later) else float(simulation.time[-1])


def window(simulation: Simulation, servo: Servo) -> tuple[float, float]:
    """The span of time in which the step settles [s]."""
    end = end_of(simulation, servo)
    own = servo.metrics
    span = end - servo.time
    if own.settling_time is not None:
        wanted = 1.6 * own.settling_time
        wanted = max(wanted, 4.0 * (own.rise_time or 0.0), 0.02 * span)
        span = min(span, wanted)
    return max(servo.time - 0.08 * span, 0.0), servo.time + span


def step_panel(ink: Ink, box: Box, simulation: Simulation, measured: Measured) -> None:
    """The response about its step, with the band, 10 to 90 %, the peak and the settling."""
    servo = simulation.servo
    if servo is None:
        return
    left, top, width, height = box
    words, quantity, *_ = LOOPS[servo.loop]
    begin, end = window(simulation, servo)
    scale = quantity.to_display(1.0)
    start, target = scale * servo.start, scale * servo.target
    size = target - start
    frame = (left + 11.0, top + 6.5, width - 14.0, height - 14.0)
    values = scaled(quantity, simulation.signals[servo.loop])
    inside = (simulation.time >= begin) & (simulation.time <= end)
    under = overlay(simulation, servo.loop, measured)
    ends = [start, target, float(np.min(values[inside])), float(np.max(values[inside]))]
    low, high = steady_range(ends)
    spare = max(0.06, ROOM / max(frame[3] - ROOM, ROOM)) * (high - low)
    low, high = (low, high + spare) if size > 0 else (low - spare, high)
    axes = Axes(ink, frame, (begin - servo.time, end - servo.time), (low, high))
    time = simulation.time - servo.time
    half = BAND * abs(size)
    upper, lower = axes.y(target + half), axes.y(target - half)
    ink.box(frame[0], upper, frame[2], lower - upper, fill=_BAND, stroke=None)
    axes.frame_at("", "", [], even_ticks(low, high, 5))
    title = titled(f"Step of {words}" if under else f"Step of the {words}", quantity)
    ink.text(left, top + 2.0, title, size=7.0, bold=True)
    ink.path(lines(axes, time, scaled(quantity, simulation.signals["reference"])), **ASKED)
    for measured_curve in under:
        ink.path(
            lines(axes, measured_curve.time - servo.time, measured_curve.values),
            **measured_curve.style,
        )
    style = STYLES[0] | {"pen": 0.4}
    ink.path(lines(axes, time, values), **style)
    entries = [("measured", under[0].style)] if under else []
    entries += [("±2 %", {"stroke": _BAND, "pen": 1.6}), ("asked", ASKED)]
    room = width - text_width(title, 7.0, bold=True) - 2.0
    names(ink, left + width, top + 2.0, entries, room)
    _rise(axes, servo, time, (values - start) / size, start, size)
    _settled(axes, servo, start, size)
    _peak(axes, servo, scale, target, size)
    time_axis(axes, "time after the step")


def _beside(axes: Axes, x: float, y: float, words: str) -> None:
    """Words to the right of a place, or to its left where there is no room."""
    wide = text_width(words, SIZE)
    right = axes.left + axes.width
    if x + 1.0 + wide <= right - 0.5:
        axes.ink.text(x + 1.0, y, words, size=SIZE, color=OCHRE, halo=True)
    else:
        at = max(x - 1.0, axes.left + wide + 0.5)
        axes.ink.text(at, y, words, size=SIZE, anchor="right", color=OCHRE, halo=True)


def _rise(axes: Axes, servo: Servo, time: Array, done: Array, start: float, size: float) -> None:
    """The rise from 10 to 90 %, marked at the lower level."""
    rise = servo.metrics.rise_time
    if rise is None:
        return
    late = np.flatnonzero((time > 0) & (done >= 0.9))
    if not late.size:
        return
    right = axes.x(float(time[late[0]]))
    left = axes.x(float(time[late[0]]) - rise)
    low, high = (axes.y(start + share * size) for share in (0.1, 0.9))
    axes.ink.line((left, low), (right, low), (right, high), **_MARK)
    for y in (low, high):
        axes.ink.circle(left if y == low else right, y, 0.5, fill=OCHRE, stroke=None)
    _beside(axes, right, low, f"rise {number(1e3 * rise, 3)} ms")


def _settled(axes: Axes, servo: Servo, start: float, size: float) -> None:
    """The last instant outside the band."""
    settling = servo.metrics.settling_time
    level = axes.y(start + 0.4 * size)
    if settling is None:
        x = axes.left + axes.width - 1.0
        words = "does not settle within 2 %"
        axes.ink.text(x, level, words, size=SIZE, anchor="right", color=OCHRE, halo=True)
        return
    x = axes.x(settling)
    if axes.left <= x <= axes.left + axes.width:
        end = axes.y(start + size)
        axes.ink.line((x, axes.y(start + 0.34 * size)), (x, end), **_MARK | {"dash": (1.0, 0.6)})
        _beside(axes, x, level, f"settled {number(1e3 * settling, 3)} ms")


def _peak(axes: Axes, servo: Servo, scale: float, target: float, size: float) -> None:
    """The overshoot, marked at its peak."""
    own = servo.metrics
    if own.overshoot < LEAST_SHOWN:
        return
    x, y = axes.x(own.peak_time), axes.y(scale * own.peak)
    if not axes.left <= x <= axes.left + axes.width:
        return
    axes.ink.line((x, y), (x, axes.y(target)), **_MARK | {"stroke": BLACK})
    axes.ink.circle(x, y, 0.6, fill=OCHRE, stroke=None)
    away = -2.2 if size > 0 else 2.2
    _beside(axes, x, y + away, f"overshoot {number(100 * own.overshoot, 3)} %")


# ---- dynamic stiffness: size and phase along the stroke ----


@dataclass(frozen=True, slots=True)
class StrokeProfile:
    """Windows of a run as drawn: place, size and phase with their errors, and their style."""

    words: str
    place: list[float]
    size: list[float]
    size_error: list[float]
    phase: list[float]
    phase_error: list[float]
    style: dict[str, Any]


def travelled(windows: Sequence[Window], stroke: float) -> bool:
    """Whether windows lie along the stroke; otherwise all lie at the same place."""
    places = [window.position for window in windows]
    return max(places) - min(places) > MOVED * stroke


def along(words: str, shaken: HarmonicLoad, over: str, style: dict[str, Any]) -> StrokeProfile:
    """Windows over the stroke (mm) or over time (s), in kN/mm and degrees.

    An error of the stiffness turns it by the same share at most: that is the phase's.
    """
    order = sorted(
        shaken.windows, key=lambda window: window.position if over == "stroke" else window.time
    )
    place = [1e3 * window.position if over == "stroke" else window.time for window in order]
    size = [abs(window.stiffness) for window in order]
    errors = [NORMAL * window.standard_error for window in order]
    turn = PHASE.to_display(1.0)
    phases = np.unwrap([float(np.angle(window.stiffness)) for window in order])
    scale = STIFFNESS.to_display(1.0)
    return StrokeProfile(
        words,
        place,
        [scale * k for k in size],
        [scale * e for e in errors],
        [turn * float(p) for p in phases],
        [turn * min(e / k, math.pi) if k > 0 else 180.0 for e, k in zip(errors, size, strict=True)],
        style,
    )


def limits_of(simulation: Simulation, metric: str) -> Limits:
    """Limits of a scenario on a result."""
    return [(row.sense, row.limit) for row in simulation.requirements if row.metric == metric]


def stiffness_panels(
    ink: Ink,
    boxes: tuple[Box, Box],
    runs: Sequence[StrokeProfile],
    over: str,
    *,
    static: Static | None = None,
    limits: tuple[Limits, Limits] = ((), ()),
    side: float = 3.0,
) -> None:
    """Size (first box) and phase (second box) of several runs; `side` is the room for limits."""
    across = _across(runs)
    xs = "position from the cap end, mm" if over == "stroke" else "time, s"
    size_box, phase_box = boxes
    shared = phase_box[0] == size_box[0] and phase_box[1] > size_box[1]
    named = [(profile.words, profile.style) for profile in runs if profile.words]
    curve = _static_curve(static, over)
    if curve is not None:
        named.append(("static", LEVEL))
    _panel(
        ink, size_box, f"Dynamic stiffness, {STIFFNESS.unit}", "" if shared else xs, across,
        [(profile.place, profile.size, profile.size_error, profile.style) for profile in runs],
        curve, [(s, STIFFNESS.to_display(v)) for s, v in limits[0]], named, side,
    )  # fmt: skip
    _panel(
        ink, phase_box, "Phase of the force, °", xs, across,
        [(profile.place, profile.phase, profile.phase_error, profile.style) for profile in runs],
        None, [(s, PHASE.to_display(v)) for s, v in limits[1]], [], side,
    )  # fmt: skip


def _across(runs: Sequence[StrokeProfile]) -> tuple[float, float]:
    places = [x for profile in runs for x in profile.place]
    low, high = min(places), max(places)
    spare = 0.04 * (high - low) or 0.5
    return low - spare, high + spare


def _static_curve(static: Static | None, over: str) -> tuple[Array, Array] | None:
    if static is None or over != "stroke":
        return None
    place, stiffness = (np.asarray(column, dtype=float) for column in static)
    return 1e3 * place, STIFFNESS.to_display(1.0) * stiffness


def _panel(
    ink: Ink,
    box: Box,
    title: str,
    x_words: str,
    across: tuple[float, float],
    series: Sequence[Series],
    static: tuple[Array, Array] | None,
    limits: Limits,
    named: Sequence[tuple[str, dict[str, Any]]],
    side: float,
) -> None:
    left, top, width, height = box
    below = 7.5 if x_words else 1.0
    frame = (left + 11.0, top + 6.5, width - 11.0 - side, height - 6.5 - below)
    ends = _ends(series)
    if static is not None:
        inside = (static[0] >= across[0]) & (static[0] <= across[1])
        ends += [float(v) for v in static[1][inside & np.isfinite(static[1])]]
    near = [v for _, v in limits if v <= 2 * max(map(abs, ends))]
    axes = Axes(ink, frame, across, steady_range([*ends, *near]))
    low, high = axes.y_range
    axes.frame_at("", "", [], even_ticks(low, high, 4 if height > 30 else 3))
    ink.text(left, top + 2.0, title, size=7.0, bold=True)
    names(ink, left + width, top + 2.0, named, width - text_width(title, 7.0, bold=True) - 2.0)
    if low < 0 < high:
        ink.line((frame[0], axes.y(0.0)), (frame[0] + frame[2], axes.y(0.0)), **ZERO)
    if static is not None:
        known = np.isfinite(static[1]) & (static[0] >= across[0]) & (static[0] <= across[1])
        xs, ys = ([float(v) for v in column[known]] for column in static)
        ink.path(axes.clipped(xs, ys), **LEVEL)
    for sense, limit in limits:
        required(axes, limit, f"{SENSES[sense]} {trimmed(limit)}")
    for xs, ys, errors, style in series:
        _drawn(axes, xs, ys, errors, style, alone=len(series) == 1)
    x_axis(axes, x_words)


def _ends(series: Sequence[Series]) -> list[float]:
    """Ends of values and bars; long bars are cut, so that values stay distinct."""
    values = [y for _, ys, _, _ in series for y in ys]
    errors = [e for _, _, es, _ in series for e in es]
    low, high = min(values), max(values)
    most = max(0.5 * (high - low), 3.0 * float(np.median(errors)), 1e-6 * max(abs(low), abs(high)))
    bars = [y + way * e for y, e in zip(values, errors, strict=True) for way in (-1, 1)]
    return [min(max(v, low - most), high + most) for v in (*values, *bars)]


def _drawn(
    axes: Axes,
    xs: list[float],
    ys: list[float],
    errors: list[float],
    style: dict[str, Any],
    *,
    alone: bool,
) -> None:
    """Marks with bars, or a line for many windows; the only run of a panel has a band."""
    colour = style["stroke"]
    if len(xs) > MOST_WINDOWS:
        if alone:
            band(axes, xs, [y - e for y, e in zip(ys, errors, strict=True)],
                 [y + e for y, e in zip(ys, errors, strict=True)])  # fmt: skip
        axes.ink.path(axes.clipped(xs, ys), **style)
        return
    if not alone:
        axes.ink.path(axes.clipped(xs, ys), **style)
    for x, y, error in zip(xs, ys, errors, strict=True):
        error_bar(axes, x, y - error, y + error, colour)
        axes.ink.circle(axes.x(x), axes.y(y), 0.6, fill=WHITE, stroke=colour, pen=0.25)


# ---- the last cycles ----


def loop_panel(ink: Ink, box: Box, simulation: Simulation) -> None:
    """Force over position in the last cycles, without drift, and the fitted ellipse."""
    shaken = simulation.shaken
    if shaken is None:
        return
    left, top, width, height = box
    last = shaken.windows[-1]
    half = min(CYCLES, simulation.scenario.analysis.window_cycles) / shaken.frequency / 2
    time, at = np.unique(simulation.time, return_index=True)
    inside = (time >= last.time - half) & (time <= last.time + half)
    if np.count_nonzero(inside) < 8:
        return
    t = time[inside]
    x, force = (simulation.signals[name][at][inside] for name in ("position", "load_force"))
    swing = [harmonic_fit(time=t, values=v, frequency=shaken.frequency) for v in (x, -force)]
    drawn_x, drawn_f = (
        v - fit.mean - fit.slope * (t - t.mean()) for v, fit in zip((x, -force), swing, strict=True)
    )
    turn = np.exp(1j * np.linspace(0.0, 2 * np.pi, 90))
    fitted_x = np.real(swing[0].amplitude * turn)
    fitted_f = np.real(last.stiffness * swing[0].amplitude * turn)
    x_scale = _micro(float(np.max(np.abs(drawn_x))))
    unit, factor = x_scale
    frame = (left + 11.0, top + 6.5, width - 14.0, height - 14.0)
    across = steady_range([float(factor * v) for values in (drawn_x, fitted_x) for v in values])
    upwards = steady_range([float(v) for values in (drawn_f, fitted_f) for v in values])
    axes = Axes(ink, frame, across, upwards)
    axes.frame_at("", "", [], even_ticks(*upwards, 4))
    title = "Last cycles: force, N"
    ink.text(left, top + 2.0, title, size=7.0, bold=True)
    room = width - text_width(title, 7.0, bold=True) - 2.0
    names(ink, left + width, top + 2.0, [("run", STYLES[0]), ("fit", ASKED)], room)
    for xs, ys, style in (
        (factor * drawn_x, drawn_f, {"stroke": BLUE, "pen": 0.25}),
        (factor * fitted_x, fitted_f, ASKED),
    ):
        ink.path(axes.clipped([float(v) for v in xs], [float(v) for v in ys]), **style)
    x_axis(axes, f"position about its mean, {unit}")


def _micro(size: float) -> tuple[str, float]:
    """Unit in which a swing has whole numbers.

    >>> _micro(4e-5), _micro(2e-3)
    (('µm', 1000000.0), ('mm', 1000.0))
    """
    return ("µm", 1e6) if size < 5e-4 else ("mm", 1e3)
