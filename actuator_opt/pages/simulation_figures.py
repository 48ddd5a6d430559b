"""Figures of a simulation: signals over time, and the panels for its kind of run."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from ..base.dataclass import dataclass
from ..base.fitting import NORMAL
from ..base.numeric import Array
from ..base.quantities import INPUTS, RESULTS, SCENARIOS, Quantity
from ..models.fluid import ATMOSPHERIC_PRESSURE
from ..rendering.axes import steady_range, time_words
from ..rendering.blocks import Chart
from ..rendering.chart import Axis, Curve, Level, Panel, Points
from ..rendering.chart_ink import drawn
from ..rendering.ink import Ink
from ..rendering.text import SENSES, number, trimmed, unit_text
from ..simulation.components.circuit import LOOPS, Loop, loop_of
from ..simulation.harmonic import harmonic_fit
from ..simulation.linear import BAND
from ..simulation.result import HarmonicLoad, Servo, Simulation, Window
from .simulation_energy import over_time, share_picture, time_panel

LEAST, MOST = 92.0, 150.0
"""Least and greatest height of the whole figure [mm]."""
WIDTHS = (96.0, 78.0)
"""Widths of the two columns: signals over time, and other panels [mm]."""
LEAST_STRIP, FOOT = 15.2, 8.4
"""Least height of a panel over time with its title, and height of the time axis below the last
panel [mm]."""
MOST_MARKS = 8
"""Largest number of events marked in the panels over time."""
LAG = 0.02
"""Samples are drawn in the chart of flow versus signal only if spool position and valve signal
differ by less than this share of the largest signal (our choice)."""
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
"""Panels over time: title, rank (the highest ranks are dropped first), whether the axis includes
zero, and signals with their names."""
_STILL = {"Stops and cushions", "Load", "Supply", "Torque on the joint", "Friction"}
"""Panels over time that are left out if none of their signals changes."""
_PUMPED = ("Supply", "Flows of the pump")
"""Panels over time that become more important if the supply pressure varies."""
LEAST_SHOWN = 0.01
"""Least overshoot that is marked, as a share of the step; less lies within the settling band."""
ROOM = 0.08
"""Space for words above the peak of the step response, as a share of the axis."""
REFERENCE, FINE = 4, 2
"""Line style and dash of a reference signal."""
EVENT, MARK, CONSTANT, VAPOUR = 2, 1, 5, 3
"""Styles: event, marked value, constant value, and vapour pressure."""
PRESSURE = INPUTS["pressure"]
STIFFNESS, PHASE = RESULTS["dynamic_stiffness"], RESULTS["dynamic_phase"]
MOVED = 0.02
"""Evaluation windows are drawn over position, not over time, if they cover more than this share of
the stroke (our choice)."""
MOST_WINDOWS = 40
"""Largest number of evaluation windows drawn as points with error bars. If there are more, they are
drawn as a line with a band."""
CYCLES = 3
"""Number of cycles drawn of the force-position loop."""
Static = tuple[Array, Array]
"""Positions [m], and the static stiffness at each [N/m]."""
Limits = Sequence[tuple[str, float]]
"""Limits: sense ("min" or "max") and value (SI)."""


# ---- the whole figure ----


class FigurePart(NamedTuple):
    """Panels that belong together, or a picture, and the least height that they need [mm]."""

    name: str
    panels: Sequence[Panel | Ink]
    least: float


class Strip(NamedTuple):
    """A panel over time; if space is short, panels with the highest rank are left out."""

    rank: int
    panel: Panel


def parts(simulation: Simulation, measured: Measured, static: Static | None) -> list[FigurePart]:
    """Panels that suit the kind of run (such as a step response), the most important first."""
    made: list[FigurePart] = []
    if simulation.servo is not None:
        panel = step_panel(simulation, simulation.servo, measured)
        made.append(FigurePart("step", [panel], 44.0))
    if simulation.shaken is not None and simulation.shaken.windows:
        panels = _stiffness(simulation, simulation.shaken, static)
        made.append(FigurePart("stiffness", panels, 40.0))
        loop = loop_panel(simulation, simulation.shaken)
        if loop is not None:
            made.append(FigurePart("cycles", [loop], 26.0))
    if simulation.scenario.held_ports is not None and np.ptp(simulation.signals["signal"]) > 0:
        made.append(FigurePart("flows", [_flows(simulation)], 40.0))
    picture = share_picture(simulation, WIDTHS[1])
    if picture is not None:
        made.append(FigurePart("energy", [picture], picture.height))
    energies = over_time(simulation)
    if len(energies) > 1:
        made.append(FigurePart("energy_time", [time_panel(simulation, energies)], 26.0))
    if "friction" in simulation.signals and np.ptp(simulation.signals["speed"]) > 0:
        made.append(FigurePart("friction", [_friction(simulation)], 38.0))
    return made


def simulation_figure(
    simulation: Simulation,
    height: float = MOST,
    *,
    measured: Measured | None = None,
    static: Static | None = None,
) -> Ink:
    """One drawing: signals over time on the left, panels for the kind of run on the right."""
    height = min(max(height, LEAST), MOST)
    cycle = simulation.cycle
    known = measured or ({} if cycle is None else cycle.traces)
    left = strips_with_room(strips(simulation, known), height)
    right: list[Panel | Ink] = []
    for part in _parts_with_room(parts(simulation, known, static), height):
        right += part.panels
    right.sort(key=lambda part: isinstance(part, Ink))  # pictures stand below
    return drawn(Chart("Simulation", [left, right], widths=WIDTHS if right else ()), height=height)


def strips_with_room(shown: Sequence[Strip], height: float) -> list[Panel]:
    """The panels over time that fit a height [mm], in order; the last has the time axis."""
    most = max(2, int((height - FOOT) / LEAST_STRIP))
    order = sorted(range(len(shown)), key=lambda k: (shown[k].rank, k))[:most]
    panels = [shown[k].panel for k in sorted(order)]
    return [*(replace(panel, x=Axis()) for panel in panels[:-1]), *panels[-1:]]


def _parts_with_room(made: Sequence[FigurePart], height: float) -> list[FigurePart]:
    """The parts that fit into the height, in order; a part that does not fit is skipped."""
    chosen: list[FigurePart] = []
    used = 0.0
    for part in made:
        if chosen and used + part.least > height:
            continue
        chosen.append(part)
        used += part.least + 2.0
    return chosen


# ---- panels of single kinds of run ----


def _stiffness(simulation: Simulation, shaken: HarmonicLoad, static: Static | None) -> list[Panel]:
    """Two panels, over stroke or time: magnitude and phase of the dynamic stiffness."""
    over = "stroke" if travelled(shaken.windows, simulation.plant.stroke) else "time"
    limits = (limits_of(simulation, "dynamic_stiffness"), limits_of(simulation, "dynamic_phase"))
    size, phase = stiffness_panels([along(shaken, over)], over, static=static, limits=limits)
    return [replace(size, x=Axis(), share=0.9), replace(phase, share=0.7)]


def _friction(simulation: Simulation) -> Panel:
    """Friction versus speed during the run."""
    force, speed = (simulation.told[name].quantity for name in ("friction", "speed"))
    across = scaled(speed, simulation.signals["speed"])
    values = scaled(force, simulation.signals["friction"])
    return Panel(
        titled("Friction versus speed", force),
        Axis(titled("speed", speed), zero=True),
        Axis(zero=True),
        curves=[Curve("", across, values, weight="thin")],
        share=0.9,
    )


def _flows(simulation: Simulation) -> Panel:
    """Flows of a valve versus its signal, from samples at which the spool follows the signal."""
    quantity, volts = simulation.told["flow_a"].quantity, SCENARIOS["signal_value"]
    signal = scaled(volts, simulation.signals["signal"])
    lag = np.abs(scaled(volts, simulation.signals["spool"]) - signal)
    near = lag <= LAG * float(np.max(np.abs(signal)))
    if np.count_nonzero(near) < 0.5 * near.size:
        near[:] = True
    return Panel(
        titled("Flows versus signal", quantity),
        Axis(titled("signal", volts)),
        Axis(zero=True),
        curves=[
            Curve(words, signal[near], scaled(quantity, simulation.signals[name])[near])
            for name, words in FLOWS
        ],
        share=1.4,
    )


# ---- signals over time ----


def scaled(quantity: Quantity, values: Array) -> Array:
    """Values in the displayed unit."""
    return np.asarray(values, dtype=float) * quantity.to_display(1.0)


def curve(
    simulation: Simulation, name: str, words: str, style: int = 0, *, start: float = 0.0
) -> Curve:
    """A signal over the time since `start` [s]."""
    values = scaled(simulation.told[name].quantity, simulation.signals[name])
    dash = FINE if style == REFERENCE else None
    return Curve(words, simulation.time - start, values, style=style, weight="thin", dash=dash)


def overlay(
    simulation: Simulation, name: str, measured: Measured, *, start: float = 0.0
) -> list[Curve]:
    """The measured or quasi-static values of a signal, drawn behind the simulated curve."""
    if name not in measured or name not in simulation.told:
        return []
    time, values = measured[name]
    shown = scaled(simulation.told[name].quantity, values)
    cycle = simulation.cycle
    words = "quasi-static" if cycle is not None and measured is cycle.traces else "measured"
    return [Curve(words, np.asarray(time, dtype=float) - start, shown, weight="broad")]


def timed(panel: Panel, span: tuple[float, float], words: str = "time") -> Panel:
    """A panel with its time axis; a short time is converted from seconds to milliseconds."""
    low, high = span
    label, factor = time_words(high - low, words)
    return replace(
        panel,
        x=Axis(label, range=(factor * low, factor * high)),
        curves=[replace(shown, xs=factor * np.asarray(shown.xs)) for shown in panel.curves],
        points=[replace(shown, xs=factor * np.asarray(shown.xs)) for shown in panel.points],
        levels=[_timed_level(level, factor) for level in panel.levels],
    )


def _timed_level(level: Level, factor: float) -> Level:
    if level.upright:
        return replace(level, value=factor * level.value)
    if level.between is None:
        return level
    return replace(level, between=(factor * level.between[0], factor * level.between[1]))


def titled(words: str, quantity: Quantity) -> str:
    """A title with its unit.

    >>> from actuator_opt.base.quantities import SCENARIOS
    >>> titled("Speed", SCENARIOS["speed_value"]), titled("Ratio", SCENARIOS["factor"])
    ('Speed, m/s', 'Ratio')
    """
    unit = unit_text(quantity.unit)
    return f"{words}, {unit}" if unit else words


def followed(simulation: Simulation) -> Loop | None:
    """The controlled quantity, else the main quantity that moves; None if nothing moves."""
    control = simulation.scenario.control
    if control is not None and "reference" in simulation.signals:
        return loop_of(control)
    return next((name for name in ("position", "shaft_speed") if name in simulation.signals), None)


def response(simulation: Simulation, measured: Measured) -> Panel | None:
    """Panel of the moving quantity with reference and measured values; None if nothing moves."""
    name = followed(simulation)
    if not name:
        return None
    words, quantity, *_ = LOOPS[name]
    curves = overlay(simulation, name, measured)
    for signal, label in (("reference", "reference"), ("drive_position", "machine")):
        if signal in simulation.signals:
            curves.append(curve(simulation, signal, label, REFERENCE))
            break
    curves.append(curve(simulation, name, "response" if curves else ""))
    return Panel(titled(words.capitalize(), quantity), curves=curves)


def strips(simulation: Simulation, measured: Measured) -> list[Strip]:
    """The signals of a run over time, the response first."""
    shown: list[Strip] = []
    first = response(simulation, measured)
    if first is not None:
        shown.append(Strip(0, first))
    if "error" in simulation.signals:
        title = titled("Error", simulation.told["error"].quantity)
        error = curve(simulation, "error", "")
        shown.append(Strip(3, Panel(title, y=Axis(zero=True), curves=[error])))
    used = followed(simulation)
    if used not in (None, "position") and "position" in simulation.signals:
        shown += _strip(simulation, measured, "Position", 5, False, (("position", ""),))
    pumped = simulation.scenario.supply.type != "constant"
    for title, rank, zero, signals in _SIGNALS:
        if used not in [name for name, _ in signals]:
            early = 3 if pumped and title in _PUMPED else rank
            shown += _strip(simulation, measured, title, early, zero, signals)
    span = (0.0, float(simulation.time[-1]))
    marks = [event.time for event in simulation.events[:MOST_MARKS]]
    events = [Level(time, "", style=EVENT, upright=True) for time in marks if 0 < time < span[1]]
    return [
        Strip(rank, timed(replace(panel, levels=[*panel.levels, *events]), span))
        for rank, panel in shown
    ]


def _strip(
    simulation: Simulation,
    measured: Measured,
    title: str,
    rank: int,
    zero: bool,
    signals: Sequence[tuple[str, str]],
) -> list[Strip]:
    """A panel for signals of one quantity; empty if the run has none of them."""
    here = [(name, words) for name, words in signals if name in simulation.signals]
    if title == "Flows of the line" and simulation.scenario.held_ports is None:
        return []
    if title in _STILL and not any(_moves(simulation.signals[name]) for name, _ in here):
        return []
    if not here:
        return []
    under = [record for name, _ in here for record in overlay(simulation, name, measured)]
    alone = "simulated" if under else ""
    over = [
        curve(simulation, name, words if len(here) > 1 else alone, style)
        for style, (name, words) in enumerate(here)
    ]
    quantity = simulation.told[here[0][0]].quantity
    levels = _levels(simulation, here[0][0])
    y = Axis(zero=zero or bool(levels))
    return [Strip(rank, Panel(titled(title, quantity), y=y, curves=[*under, *over], levels=levels))]


def _moves(values: Array) -> bool:
    return float(np.ptp(values)) > 1e-9 * max(float(np.max(np.abs(values))), 1e-12)


def _levels(simulation: Simulation, name: str) -> list[Level]:
    """Lines at constant values: pressures of supply, return and vapour, largest valve signal."""
    if name == "pressure_a":
        plant = simulation.plant
        vapour = PRESSURE.to_display(plant.oil.vapour_pressure - ATMOSPHERIC_PRESSURE)
        level = Level(vapour, "vapour", style=VAPOUR)
        supply = simulation.signals.get("pressure_supply")
        if supply is None:
            return [level] if float(np.min(simulation.signals[name])) < 0 else []
        pressures = [plant.return_pressure] + ([] if _moves(supply) else [plant.supply_pressure])
        words = "supply, return" if len(pressures) > 1 else "return"
        constant = [Level(PRESSURE.to_display(p), words, style=CONSTANT) for p in pressures]
        return [*constant, level]
    if name == "signal" and simulation.plant.valve is not None:
        full = simulation.plant.valve.signal
        if float(np.max(np.abs(simulation.signals[name]))) > 0.5 * full:
            return [Level(way * full, "limit", style=CONSTANT) for way in (1, -1)]
    return []


# ---- step response of a servo: rise, overshoot and settling ----


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


def step_panel(simulation: Simulation, servo: Servo, measured: Measured) -> Panel:
    """Panel of the step response with settling band, 10 to 90 % rise, peak, and settling time."""
    words, quantity, *_ = LOOPS[servo.loop]
    begin, end = window(simulation, servo)
    start, target = quantity.to_display(servo.start), quantity.to_display(servo.target)
    size = target - start
    own = curve(simulation, servo.loop, "", start=servo.time)
    own = replace(own, weight="normal")
    reference = curve(simulation, "reference", "reference, ±2 %", REFERENCE, start=servo.time)
    at_target = np.abs(np.asarray(reference.ys) - target) <= 1e-9 * abs(size)
    bounds = (np.where(at_target, target + way * BAND * abs(size), np.nan) for way in (-1, 1))
    reference = replace(reference, low=next(bounds), high=next(bounds))
    under = overlay(simulation, servo.loop, measured, start=servo.time)
    marks, points, levels = _rise(servo, own, start, size)
    note = ""
    settling = servo.metrics.settling_time
    if settling is None:
        note = "The response does not settle within 2 %."
    elif settling <= end - servo.time:
        level = float(np.interp(settling, *_sorted(own)))
        settling_label = f"settling {number(1e3 * settling, 3)} ms"
        points.append(Points("", [settling], [level], style=2, labels=[settling_label]))
        levels.append(Level(settling, "", style=MARK, upright=True))
    if servo.metrics.overshoot >= LEAST_SHOWN and servo.metrics.peak_time <= end - servo.time:
        at, peak = servo.metrics.peak_time, quantity.to_display(servo.metrics.peak)
        overshoot = f"overshoot {number(100 * servo.metrics.overshoot, 3)} %"
        marks.append(Curve("", [at, at], [target, peak], style=4, dash=0, weight="thin"))
        points.append(Points("", [at], [peak], style=2, labels=[overshoot]))
    time, values = np.asarray(own.xs), np.asarray(own.ys)
    inside = values[(time >= begin - servo.time) & (time <= end - servo.time)]
    low, high = steady_range([start, target, float(np.min(inside)), float(np.max(inside))])
    spare = ROOM * (high - low)
    panel = Panel(
        titled(f"Step of {words}" if under else f"Step of the {words}", quantity),
        y=Axis(range=(low, high + spare) if size > 0 else (low - spare, high)),
        curves=[*under, reference, own, *marks],
        points=points,
        levels=levels,
        note=note,
        share=1.5,
    )
    return timed(panel, (begin - servo.time, end - servo.time), "time after the step")


def _sorted(shown: Curve) -> tuple[Array, Array]:
    """Times and values of a curve; if an instant has two samples, the later is used."""
    time, at = np.unique(np.asarray(shown.xs)[::-1], return_index=True)
    return time, np.asarray(shown.ys)[::-1][at]


def _rise(
    servo: Servo, own: Curve, start: float, size: float
) -> tuple[list[Curve], list[Points], list[Level]]:
    """Marks for the rise time from 10 to 90 %; its dimension line is drawn at the 10 % level."""
    rise = servo.metrics.rise_time
    time, values = np.asarray(own.xs), np.asarray(own.ys)
    late = np.flatnonzero((time > 0) & ((values - start) / size >= 0.9))
    if rise is None or not late.size:
        return [], [], []
    last = float(time[late[0]])
    low, high = (start + share * size for share in (0.1, 0.9))
    words = f"rise {number(1e3 * rise, 3)} ms"
    return (
        [Curve("", [last, last], [low, high], style=MARK, dash=0, weight="thin")],
        [Points("", [last - rise, last], [low, high], style=2)],
        [Level(low, words, style=MARK, between=(last - rise, last))],
    )


# ---- dynamic stiffness: magnitude and phase along the stroke ----


@dataclass(frozen=True, slots=True)
class StrokeProfile:
    """Dynamic stiffness of a run as drawn: position, magnitude, phase and errors per window."""

    place: list[float]
    size: list[float]
    size_error: list[float]
    phase: list[float]
    phase_error: list[float]
    style: int = 0
    dash: int | None = None


def travelled(windows: Sequence[Window], stroke: float) -> bool:
    """Whether the evaluation windows lie along the stroke, and not all at one position."""
    places = [window.position for window in windows]
    return max(places) - min(places) > MOVED * stroke


def along(
    shaken: HarmonicLoad, over: str, style: int = 0, dash: int | None = None
) -> StrokeProfile:
    """Dynamic stiffness in the evaluation windows (kN/mm, degrees).

    `over` states what it is drawn over: "stroke" (mm) or time (s).

    A relative error of the stiffness changes its phase by at most the same number of radians.
    """
    windows = sorted(
        shaken.windows, key=lambda window: window.position if over == "stroke" else window.time
    )
    sizes = [abs(window.stiffness) for window in windows]
    errors = [NORMAL * window.standard_error for window in windows]
    phases = np.unwrap([float(np.angle(window.stiffness)) for window in windows])
    turns = [min(e / k, math.pi) if k > 0 else math.pi for e, k in zip(errors, sizes, strict=True)]
    scale = STIFFNESS.to_display(1.0)
    return StrokeProfile(
        [1e3 * window.position if over == "stroke" else window.time for window in windows],
        [scale * size for size in sizes],
        [scale * error for error in errors],
        [PHASE.to_display(float(phase)) for phase in phases],
        [PHASE.to_display(turn) for turn in turns],
        style,
        dash,
    )


def limits_of(simulation: Simulation, metric: str) -> Limits:
    """The scenario's limits on a result."""
    return [(row.sense, row.limit) for row in simulation.requirements if row.metric == metric]


def stiffness_panels(
    profiles: Sequence[StrokeProfile],
    over: str,
    *,
    static: Static | None = None,
    limits: tuple[Limits, Limits] = ((), ()),
) -> tuple[Panel, Panel]:
    """Panels with magnitude and phase of the dynamic stiffness, for one run or several."""
    places = [place for profile in profiles for place in profile.place]
    low, high = min(places), max(places)
    spare = 0.04 * (high - low) or 0.5
    label = "position from the cap end, mm" if over == "stroke" else "time, s"
    x = Axis(label, range=(low - spare, high + spare))
    beside: list[Curve] = []
    if static is not None and over == "stroke":
        across, stiffness = (np.asarray(column, dtype=float) for column in static)
        across, stiffness = 1e3 * across, STIFFNESS.to_display(1.0) * stiffness
        inside = (across >= low - spare) & (across <= high + spare)
        beside = [Curve("static", across[inside], stiffness[inside], weight="guide", dash=1)]
    sizes = [(profile.size, profile.size_error) for profile in profiles]
    phases = [(profile.phase, profile.phase_error) for profile in profiles]
    title = titled("Dynamic stiffness", STIFFNESS)
    return (
        _profile_panel(title, x, profiles, sizes, beside, STIFFNESS, limits[0]),
        _profile_panel("Phase of the force, °", x, profiles, phases, [], PHASE, limits[1]),
    )


def _profile_panel(
    title: str,
    x: Axis,
    profiles: Sequence[StrokeProfile],
    values: Sequence[tuple[list[float], list[float]]],
    beside: Sequence[Curve],
    quantity: Quantity,
    limits: Limits,
) -> Panel:
    """Panel of values with their errors: points with error bars, or a line for many windows.

    Points are connected only if there are several runs; a line has an error band only for a single
    run.
    """
    alone = len(profiles) == 1
    curves, points = [*beside], []
    for profile, (ys, errors) in zip(profiles, values, strict=True):
        low = [y - error for y, error in zip(ys, errors, strict=True)]
        high = [y + error for y, error in zip(ys, errors, strict=True)]
        style, many = profile.style, len(ys) > MOST_WINDOWS
        if many or not alone:
            line = Curve("", profile.place, ys, style=style, dash=profile.dash)
            curves.append(replace(line, low=low, high=high) if alone else line)
        if not many:
            small = not alone
            points.append(Points("", profile.place, ys, low, high, style=style, small=small))
    ends = _ends(values)
    ends += [float(v) for shown in beside for v in shown.ys if math.isfinite(v)]
    levels = [
        Level(quantity.to_display(limit), f"{SENSES[sense]} {trimmed(quantity.to_display(limit))}",
              "min" if sense == "min" else "max")
        for sense, limit in limits
    ]  # fmt: skip
    ends += [level.value for level in levels if level.value <= 2 * max(map(abs, ends))]
    y = Axis(range=steady_range(ends))
    return Panel(title, x, y, curves=curves, points=points, levels=levels)


def _ends(values: Sequence[tuple[list[float], list[float]]]) -> list[float]:
    """Values for the axis range; long error bars are cut to keep the values distinguishable."""
    ys = [y for column, _ in values for y in column]
    errors = [error for _, column in values for error in column]
    low, high = min(ys), max(ys)
    most = max(0.5 * (high - low), 3.0 * float(np.median(errors)), 1e-6 * max(abs(low), abs(high)))
    bars = [y + way * error for y, error in zip(ys, errors, strict=True) for way in (-1, 1)]
    return [min(max(value, low - most), high + most) for value in (*ys, *bars)]


# ---- the last cycles ----


def loop_panel(simulation: Simulation, shaken: HarmonicLoad) -> Panel | None:
    """Force over position in the last cycles, with drift removed, and the fitted ellipse."""
    last = shaken.windows[-1]
    half = min(CYCLES, simulation.scenario.analysis.window_cycles) / shaken.frequency / 2
    time, at = np.unique(simulation.time, return_index=True)
    inside = (time >= last.time - half) & (time <= last.time + half)
    if np.count_nonzero(inside) < 8:
        return None
    t = time[inside]
    x, force = (simulation.signals[name][at][inside] for name in ("position", "load_force"))
    fits = [harmonic_fit(time=t, values=v, frequency=shaken.frequency) for v in (x, -force)]
    swings = [
        values - fit.mean - fit.slope * (t - t.mean())
        for values, fit in zip((x, -force), fits, strict=True)
    ]
    turn = np.exp(1j * np.linspace(0.0, 2 * np.pi, 90))
    ellipse_x = np.real(fits[0].amplitude * turn)
    ellipse_force = np.real(last.stiffness * fits[0].amplitude * turn)
    unit, factor = _micro(float(np.max(np.abs(swings[0]))))
    return Panel(
        "Last cycles: force, N",
        Axis(f"position minus its mean, {unit}"),
        curves=[
            Curve("run", factor * swings[0], swings[1], weight="thin"),
            Curve("fit", factor * ellipse_x, ellipse_force, (), (), REFERENCE, "thin", dash=FINE),
        ],
    )


def _micro(size: float) -> tuple[str, float]:
    """Unit for a small displacement, chosen so that its values are easy to read.

    >>> _micro(4e-5), _micro(2e-3)
    (('µm', 1000000.0), ('mm', 1000.0))
    """
    return ("µm", 1e6) if size < 5e-4 else ("mm", 1e3)
