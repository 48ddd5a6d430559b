"""Figures of a Simulation as ink: strips over time, and the panels that its kind of run has."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ..base.quantities import SCENARIOS
from ..rendering.axes import Axes, Box, even_ticks, thinned
from ..rendering.ink import BLUE, Ink, text_width
from ..rendering.text import unit_text
from ..simulation.result import Simulation
from .simulation_axes import STYLES, ZERO, kept, names, stack, steady_range, x_axis
from .simulation_energy import ROW, TOP, over_time, rows_of, share_panel, time_panel
from .simulation_series import Measured, scaled, strips, titled
from .simulation_step import step_panel
from .simulation_stiffness import Static, along, limits_of, loop_panel, stiffness_panels, travelled

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


@dataclass(frozen=True, slots=True)
class Panel:
    """A figure that fills a box: a fixed height, or a weight in what is left [mm]."""

    name: str
    draw: Callable[[Ink, Box], None]
    height: float = 0.0
    weight: float = 1.0
    least: float = LEAST_PANEL


def panels(found: Simulation, measured: Measured, static: Static | None) -> list[Panel]:
    """What this run has beside its strips, the most telling first."""
    made = []
    if found.servo is not None:
        made.append(
            Panel("step", lambda ink, box: step_panel(ink, box, found, measured), 0.0, 1.5, 44.0)
        )
    if found.shaken is not None and found.shaken.windows:
        made.append(
            Panel("stiffness", lambda ink, box: _stiffness(ink, box, found, static), 0.0, 1.6, 40.0)
        )
        made.append(Panel("cycles", lambda ink, box: loop_panel(ink, box, found)))
    if found.scenario.held_ports is not None and np.ptp(found.signals["signal"]) > 0:
        made.append(Panel("flows", lambda ink, box: _flows(ink, box, found), 0.0, 1.4, 40.0))
    count = rows_of(found)
    if count:
        made.append(
            Panel("energy", lambda ink, box: share_panel(ink, box, found), TOP + ROW * count + 1.0)
        )
    curves = over_time(found)
    if len(curves) > 1:
        made.append(
            Panel("energy_time", lambda ink, box: time_panel(ink, box, found, curves), weight=0.9)
        )
    if "friction" in found.signals and np.ptp(found.signals["speed"]) > 0:
        made.append(Panel("friction", lambda ink, box: _friction(ink, box, found), 0.0, 0.9, 38.0))
    return made


def simulation_figure(
    found: Simulation,
    height: float = MOST,
    *,
    measured: Measured | None = None,
    static: Static | None = None,
) -> Ink:
    """Strips over time at the left, the panels of this run at the right, in one drawing."""
    height = min(max(height, LEAST), MOST)
    ink = Ink(WIDTH, height)
    known = measured or {}
    right = _chosen(panels(found, known, static), height)
    shown = strips(found, known)
    wide = STRIPS if right else WIDTH - LEFT - 2.0
    stack(ink, (LEFT, 0.0, wide, height), shown, (0.0, _end(found)), marks=_marks(found))
    if not right:
        return ink
    left = LEFT + STRIPS + GAP
    fixed = sum(one.height for one in right)
    weights = sum(one.weight for one in right if not one.height)
    gaps = 2.0 * (len(right) - 1)
    share = (height - fixed - gaps) / weights if weights else 0.0
    y = 0.0
    for one in right:
        tall = one.height or min(share * one.weight, 70.0 * one.weight)
        one.draw(ink, (left, y, WIDTH - left, tall))
        y += tall + 2.0
    return ink


def _chosen(made: list[Panel], height: float) -> list[Panel]:
    """As many panels as have room; of the rest the first count more."""
    chosen: list[Panel] = []
    used = 0.0
    for one in made:
        need = one.height or one.least
        if chosen and used + need > height:
            continue
        chosen.append(one)
        used += need + 2.0
    return chosen


def _end(found: Simulation) -> float:
    return float(found.time[-1])


def _marks(found: Simulation) -> list[float]:
    """Instants of the first events."""
    return [one.time for one in found.events[:MOST_MARKS]]


def figures(
    found: Simulation, *, measured: Measured | None = None, static: Static | None = None
) -> dict[str, Ink]:
    """Every figure of a run alone: the signals over time, and each panel by its name."""
    known = measured or {}
    shown = strips(found, known)
    tall = 20.0 * len(shown) + 8.0
    signals = Ink(120.0, tall)
    box = (LEFT, 0.0, 120.0 - LEFT - 4.0, tall)
    everything = kept(shown, 1e9)
    stack(signals, box, everything, (0.0, _end(found)), marks=_marks(found))
    made = {"signals": signals}
    for one in panels(found, known, static):
        height = one.height or 60.0 * max(one.weight, 1.0)
        ink = Ink(90.0, height)
        one.draw(ink, (1.0, 0.0, 88.0, height))
        made[one.name] = ink
    return made


# ---- panels of single kinds of run ----


def _stiffness(ink: Ink, box: Box, found: Simulation, static: Static | None) -> None:
    """Size above phase, along the stroke or over time."""
    shaken = found.shaken
    assert shaken is not None
    left, top, width, height = box
    over = "stroke" if travelled(shaken.windows, found.plant.stroke) else "time"
    one = along("", shaken, over, STYLES[0])
    limits = (limits_of(found, "dynamic_stiffness"), limits_of(found, "dynamic_phase"))
    upper = 0.56 * height
    boxes = ((left, top, width, upper), (left, top + upper, width, height - upper))
    side = 12.0 if any(limits) else 3.0
    stiffness_panels(ink, boxes, [one], over, static=static, limits=limits, side=side)


def _friction(ink: Ink, box: Box, found: Simulation) -> None:
    """Friction over speed, as the run went."""
    left, top, width, height = box
    force, speed = (found.told[name].quantity for name in ("friction", "speed"))
    xs, ys = (scaled(found.told[n].quantity, found.signals[n]) for n in ("speed", "friction"))
    frame = (left + 11.0, top + 6.5, width - 14.0, height - 14.0)
    ranges = [steady_range([float(np.min(v)), float(np.max(v))], zero=True) for v in (xs, ys)]
    axes = Axes(ink, frame, ranges[0], ranges[1])
    axes.frame_at("", "", [], even_ticks(*ranges[1], 4))
    ink.text(left, top + 2.0, titled("Friction over speed", force), size=7.0, bold=True)
    _cross(axes)
    at = np.union1d(thinned(xs, 2000), thinned(ys, 2000))
    points = ([float(v) for v in one[at]] for one in (xs, ys))
    ink.path(axes.clipped(*points), stroke=BLUE, pen=0.2)
    x_axis(axes, titled("speed", speed))


def _cross(axes: Axes) -> None:
    """Lines at zero, where it lies inside."""
    (left, right), (low, high) = axes.x_range, axes.y_range
    if left < 0 < right:
        axes.ink.line((axes.x(0.0), axes.y(low)), (axes.x(0.0), axes.y(high)), **ZERO)
    if low < 0 < high:
        axes.ink.line((axes.x(left), axes.y(0.0)), (axes.x(right), axes.y(0.0)), **ZERO)


def _flows(ink: Ink, box: Box, found: Simulation) -> None:
    """Flows of a valve over its signal, the spool being where the signal wants it."""
    left, top, width, height = box
    quantity, volts = found.told["flow_a"].quantity, SCENARIOS["signal_value"]
    signal = scaled(volts, found.signals["signal"])
    lag = np.abs(scaled(volts, found.signals["spool"]) - signal)
    there = lag <= LAG * float(np.max(np.abs(signal)))
    if np.count_nonzero(there) < 0.5 * there.size:
        there[:] = True
    entries = [
        (words, scaled(quantity, found.signals[name])[there], style)
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
        xs, ys = ([float(v) for v in one[at]] for one in (signal, values))
        ink.path(axes.clipped(xs, ys), **style | {"pen": 0.35})
    room = width - text_width(title, 7.0, bold=True) - 2.0
    names(ink, left + width, top + 2.0, [(words, style) for words, _, style in entries], room)
    x_axis(axes, f"signal, {unit_text(volts.unit)}")
