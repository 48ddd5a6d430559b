"""Figures of duty cycles: traces over time, force over speed, energies, linkage, temperatures."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from ..base.numeric import Array
from ..base.quantities import INPUTS, SCENARIOS, Quantity
from ..evaluation.duty_cycles.study import (
    CycleStudy,
    DutyStudy,
    LinkageSize,
    Warming,
    WarmingPlace,
)
from ..metrics import METRICS
from ..rendering.axes import even_range, time_words
from ..rendering.blocks import Chart, TerminalFigure, clean
from ..rendering.chart import Axis, Curve, Level, Panel, Points, known
from ..rendering.ink import BLACK, BLUE, GREY, WHITE, Ink, Point
from ..rendering.text import DASH, limit_text, number, unit_text, value_text
from ..rendering.waterfall import WaterfallBar, waterfall
from .section import choose_scale, scale_bar

WIDTHS = (96.0, 78.0)
"""Widths of the traces over time, and of what is beside them [mm]."""
STRIP, FOOT = 18.6, 8.4
"""Height of a trace over time, and of the time axis below the last [mm]."""
FAINT = "#a9b4bc"
"""Colour of the linkage at both ends of a cycle."""
POSE = 46.0
"""Largest height of the linkage [mm]."""
BEYOND = 1.15
"""The plane of force and speed ends at this multiple of the largest force (our choice)."""
NEAR = 2.5
"""A line farther from zero than this multiple of the values does not widen their panel (our
choice)."""
ENLARGED = 0.4
"""A cycle that spans less of the plane of force and speed than this is also drawn enlarged."""
MOST_PANELS = 3
"""Largest number of cycles in the figure of temperatures, those with the least reserve."""
LONG = 600.0
"""Time from which minutes replace seconds [s]; 60 times as much, from which hours do."""
WARMING_TITLE = "Duty cycles: temperatures from cold"
PROFILE = 400
"""Points of the curve on the terminal."""
CYCLE, RESERVE, MEAN, LIMIT, CONSTANT = 0, 1, 2, 4, 5
"""Styles of curves and lines."""
SOLID = 0
FILLED, OPEN = 3, 2
"""Styles of marks."""
ANGLE, TORQUE, ARM = INPUTS["joint_angle"], INPUTS["torque"], INPUTS["lever_arm"]
LENGTH, PRESSURE, SPEED = INPUTS["position"], INPUTS["pressure"], SCENARIOS["speed_value"]
FORCE, FLOW, POWER = (METRICS[f"duty_{x}"] for x in ("force_margin", "flow_peak", "power_peak"))
OPENING, ENERGY = METRICS["duty_opening"], METRICS["duty_supply_energy"]
TEMPERATURE = INPUTS["temperature"]
EFFICIENCY, DAMAGE = METRICS["duty_efficiency"], METRICS["duty_fatigue"]
_SPLIT: tuple[tuple[str, str, float], ...] = (
    ("supply", "supply_energy", 1.0),
    ("work of the load", "work_in", 1.0),
    ("work on the load", "work_out", -1.0),
    ("throttling", "throttling_energy", -1.0),
    ("leakage", "leakage_energy", -1.0),
    ("return line", "return_energy", -1.0),
    ("friction", "friction_energy", -1.0),
)
"""Sources and sinks of energy: name, key, and sign in the balance."""


def trace_of(cycle: CycleStudy, name: str) -> Array | None:
    """A trace by name, also joint angle and torque; None if the cycle does not have it."""
    if name == "angle":
        return cycle.record.motion if cycle.record.joint else None
    if name == "torque":
        return cycle.traces["force"] * cycle.traces["arm"] if cycle.record.joint else None
    if name == "arm" and not cycle.record.joint:
        return None
    return cycle.traces.get(name)


def time_of(cycle: CycleStudy, index: int) -> str:
    """The time of a sample."""
    label, factor = time_words(float(np.ptp(cycle.time)))
    unit = label.rpartition(" ")[2]
    return f"{number(factor * float(cycle.time[index]), 3)} {unit}"


def value_of(quantity: Quantity, value: float | None) -> str:
    """A value with three digits and its unit."""
    return value_text(quantity, value, 3)


def efficiency_of(cycle: CycleStudy) -> str:
    """Efficiency of a cycle, or why it has none."""
    if cycle.way == 0:
        return "nothing moves"
    return DASH if cycle.efficiency is None else value_of(EFFICIENCY, cycle.efficiency)


def balance_of(cycle: CycleStudy) -> list[tuple[str, float]]:
    """Sources of energy (positive), then sinks; parts that are zero are left out."""
    parts = [(name, sign * cycle.energies[key]) for name, key, sign in _SPLIT]
    parts = [(name, value) for name, value in parts if value or name == "work on the load"]
    return sorted(parts, key=lambda part: part[1] <= 0)


def figure(lengths: Mapping[str, float], study: DutyStudy, cycle: CycleStudy) -> Chart:
    """The cycle over time; beside it force over speed, energies, and the linkage."""
    panels = strips(study, cycle)
    beside: list[Panel | Ink] = [*planes(study, cycle)]
    if (picture := _energy_picture(cycle)) is not None:
        beside.append(picture)
    if study.linkage is not None and cycle.linked:
        beside.append(_pose(lengths, study.linkage, cycle))
    percent = 100 * cycle.traces["share"]
    label = f"Cycle {clean(cycle.name)}: supply pressure needed, % of the supply"
    return Chart(
        f"Duty cycle {clean(cycle.name)}",
        [panels, beside],
        _note(study, cycle),
        instead=_profile(label, cycle, percent),
        height=FOOT + STRIP * len(panels),
        widths=WIDTHS,
    )


def _profile(title: str, cycle: CycleStudy, values: Array) -> TerminalFigure:
    """A trace on the terminal; each point is the largest value of its stretch of time."""
    edges = np.unique(np.linspace(0, values.size, PROFILE + 1).astype(int))[:-1]
    time = cycle.time - cycle.time[0]
    points = zip(time[edges].tolist(), np.maximum.reduceat(values, edges).tolist(), strict=True)
    ends = time_of(cycle, 0), time_of(cycle, -1)
    return TerminalFigure(title, list(points), 100.0, ends)


def _note(study: DutyStudy, cycle: CycleStudy) -> str:
    reserve = cycle.worst["reserve"]
    state = cycle.state(reserve.sample)
    time, piston = time_of(cycle, reserve.sample), value_of(LENGTH, state["position"])
    joint = f"joint at {value_of(ANGLE, state['joint_angle'])}, " if cycle.record.joint else ""
    words = [
        f"Vertical line: least force reserve, {value_of(FORCE, reserve.value)} at {time} "
        f"({joint}piston at {piston}).",
        "Force is that on the load; positive pushes out.",
    ]
    if study.opening_limit is None:
        words.append("Shaded: forces that the supply moves; no valve is stated.")
    else:
        share = limit_text(OPENING, "max", study.opening_limit)[2:]
        words.append(
            f"Shaded: loads that the supply moves with the valve at most {share} open, down to "
            "where the driving chamber falls to the pressure of the air. Dashed: valve fully open."
        )
    if np.ptp(cycle.traces["supply"]) > 0:
        words.append("The limits are those at the least supply pressure of the cycle.")
    return " ".join(words)


class _Strip(NamedTuple):
    """A panel over time: title, quantity, traces by name, and lines."""

    title: str
    quantity: Quantity
    curves: Mapping[str, Array]
    levels: Sequence[Level] = ()
    zero: bool = False
    marked: tuple[str, int] | None = None
    """Words and sample of a mark on the first curve."""


def strips(study: DutyStudy, cycle: CycleStudy) -> list[Panel]:
    """The traces over time; the last panel has the time axis."""
    made = [*_motion(study, cycle), *_hydraulics(study, cycle)]
    label, factor = time_words(float(np.ptp(cycle.time)))
    time = factor * cycle.time
    ends = float(time[0]), float(time[-1])
    line = Level(float(time[cycle.worst["reserve"].sample]), "", style=RESERVE, upright=True)
    panels = []
    for strip in made:
        scale = strip.quantity.to_display(1.0)
        curves = [
            Curve(words, time, scale * np.where(np.isfinite(values), values, np.nan), weight="thin")
            for words, values in strip.curves.items()
        ]
        points = []
        if strip.marked is not None:
            words, at = strip.marked
            height = float(np.asarray(curves[_owner(strip, at)].ys)[at])
            points = [Points("", [float(time[at])], [height], style=FILLED, labels=[words])]
        unit = unit_text(strip.quantity.unit)
        panels.append(
            Panel(
                f"{strip.title}, {unit}",
                Axis(label if strip is made[-1] else "", range=ends),
                Axis(zero=strip.zero, range=_range(curves, strip.levels) if points else None),
                curves=curves,
                points=points,
                levels=[*strip.levels, line],
            )
        )
    return panels


def _range(curves: Sequence[Curve], levels: Sequence[Level]) -> tuple[float, float]:
    """Range of a panel with a mark: zero, all values, and the lines that are not far from them."""
    ends = [float(end(np.asarray(curve.ys))) for curve in curves for end in (np.nanmin, np.nanmax)]
    most = NEAR * max(map(abs, ends))
    return even_range([*ends, *(x.value for x in levels if abs(x.value) <= most)], zero=True)


def _owner(strip: _Strip, at: int) -> int:
    """The curve of a strip that is lowest at a sample; the only one if it has one."""
    values = [float(curve[at]) for curve in strip.curves.values()]
    return values.index(min(values))


def _motion(study: DutyStudy, cycle: CycleStudy) -> Iterator[_Strip]:
    """Angle, torque and lever arm of a joint; position, force and speed of the piston."""
    traces = cycle.traces
    for title, name, quantity in (
        ("Joint angle", "angle", ANGLE),
        ("Joint torque", "torque", TORQUE),
        ("Lever arm", "arm", ARM),
    ):
        values = trace_of(cycle, name)
        if values is not None:
            yield _Strip(title, quantity, {"": values}, zero=name == "torque")
    stops = [Level(0.0, "stops", style=CONSTANT)]
    stops.append(Level(LENGTH.to_display(study.stroke), "", style=CONSTANT))
    yield _Strip("Position of the piston", LENGTH, {"": traces["position"]}, stops)
    rubbed = traces["force"] + np.sign(traces["speed"]) * traces["friction"]
    forces = {"on the load": traces["force"], "with friction": rubbed}
    yield _Strip("Force", FORCE, forces, zero=True)
    yield _Strip("Speed", SPEED, {"": traces["speed"]}, zero=True)


def _hydraulics(study: DutyStudy, cycle: CycleStudy) -> Iterator[_Strip]:
    """Pressures, pressure needed, opening of the valve, and flow from the supply."""
    traces, worst = cycle.traces, cycle.worst
    supply = traces["supply"]
    lowest = min((worst["pressure_a"], worst["pressure_b"]), key=lambda sample: sample.value)
    constant = [Level(PRESSURE.to_display(study.return_pressure), "supply, return", style=CONSTANT)]
    chambers = {"A": traces["pressure_a"], "B": traces["pressure_b"]}
    limits: list[Level] = []
    needed = {"": traces["needed"]}
    if np.ptp(supply) > 0:
        chambers["supply"] = supply
        needed = {"needed": traces["needed"], "supply": supply}
        constant = [replace(constant[0], words="return")]
    else:
        level = PRESSURE.to_display(float(supply[0]))
        constant.append(Level(level, "", style=CONSTANT))
        limits = [Level(level, limit_text(PRESSURE, "max", float(supply[0])), "max")]
    words = f"least {value_of(PRESSURE, lowest.value)}"
    yield _Strip("Pressures", PRESSURE, chambers, constant, True, (words, lowest.sample))
    most = worst["share"]
    words = f"{value_of(OPENING, most.value)} of the supply"
    yield _Strip("Supply pressure needed", PRESSURE, needed, limits, True, (words, most.sample))
    if study.opening_limit is not None:
        limit = limit_text(OPENING, "max", study.opening_limit)
        most_open = Level(OPENING.to_display(study.opening_limit), limit, "max")
        opening = worst["opening"]
        moves = math.isfinite(opening.value)
        marked = (value_of(OPENING, opening.value), opening.sample) if moves else None
        curve = {"": traces["opening"]}
        title = "Valve opening" if moves else "Valve opening (gaps: stall)"
        yield _Strip(title, OPENING, curve, [most_open], True, marked)
    flow = worst["flow"]
    mean = Level(FLOW.to_display(cycle.flow_mean), "mean", style=MEAN)
    peak = value_of(FLOW, flow.value), flow.sample
    yield _Strip("Flow from the supply", FLOW, {"": traces["flow"]}, [mean], True, peak)


def planes(study: DutyStudy, cycle: CycleStudy) -> list[Panel]:
    """The cycle in the plane of force and speed: with all limits and, if it is small, enlarged."""
    scale, across = FORCE.to_display(1.0), SPEED.to_display(1.0)
    speed, force = across * cycle.traces["speed"], scale * cycle.traces["force"]
    stalls = [scale * float(limit.force[0]) for limit in cycle.limits]
    low, high = (BEYOND * end(known([*stalls, *force, 0.0])) for end in (min, max))
    limits = _limit_curves(cycle, low, high)
    ends = [float(speed.min()), float(speed.max())]
    for curve in limits:
        inside = (np.asarray(curve.ys) >= low) & (np.asarray(curve.ys) <= high)
        ends += np.asarray(curve.xs)[inside].tolist()
    room = 0.04 * (max(ends) - min(ends))
    span = min(ends) - room, max(ends) + room
    own = Curve("cycle", speed, force, style=CYCLE, weight="thin")
    reserve = cycle.worst["reserve"]
    at = float(speed[reserve.sample]), float(force[reserve.sample])
    mark = Points("", [at[0]], [at[1]], style=OPEN, labels=["least reserve"])
    title = f"Force on the load, {unit_text(FORCE.unit)}, over speed"
    label = f"speed, {unit_text(SPEED.unit)}"
    whole = Panel(
        title,
        Axis(label, range=span),
        Axis(range=(low, high)),
        curves=[*limits, *_reserve_line(limits, at), own],
        points=[mark],
    )
    shares = np.ptp(force) / (high - low), np.ptp(speed) / (span[1] - span[0] or 1.0)
    if min(shares) > ENLARGED or cycle.way == 0 or not cycle.limits:
        return [whole]
    marks = []
    for key, words in (
        ("power", "peak power"),
        ("absorbed", "peak absorbed"),
        ("flow", "peak flow"),
    ):
        spot = cycle.worst[key].sample
        if spot != reserve.sample:
            spots = [float(speed[spot])], [float(force[spot])]
            marks.append(Points("", *spots, style=FILLED, labels=[words]))
    enlarged = Panel(
        "The cycle enlarged",
        Axis(label, range=even_range(ends[:2], zero=True)),
        Axis(range=even_range([float(force.min()), float(force.max())], zero=True)),
        curves=[replace(own, words="", weight="normal")],
        points=[*marks, mark],
        share=0.7,
    )
    return [whole, enlarged]


def _limit_curves(cycle: CycleStudy, low: float, high: float) -> list[Curve]:
    """Limits as shown; that at the opening limit is shaded towards the loads that are moved."""
    scale, across = FORCE.to_display(1.0), SPEED.to_display(1.0)
    curves = []
    for limit in cycle.limits:
        inner = limit.opening == cycle.limits[0].opening
        words = ""
        if limit.direction == "extending" and limit.opening is not None:
            share = limit_text(OPENING, "max", limit.opening)[2:]
            words = f"{share} open" if inner else "fully open"
        curve = Curve(words, across * limit.speed, scale * limit.force, style=LIMIT)
        if not inner:
            curves.append(replace(curve, weight="thin"))
            continue
        far = np.full(limit.speed.shape, low if limit.direction == "extending" else high)
        far = far if limit.suction is None else scale * limit.suction
        both = [np.clip(values, low, high) for values in (scale * limit.force, far)]
        curves.append(replace(curve, low=np.minimum(*both), high=np.maximum(*both), dash=SOLID))
    return curves


def _reserve_line(limits: Sequence[Curve], at: tuple[float, float]) -> Iterator[Curve]:
    """A line from a sample to the shaded limit at its speed."""
    for curve in limits:
        xs = np.abs(np.asarray(curve.xs))
        if len(curve.low) and (np.asarray(curve.xs)[-1] >= 0) == (at[0] >= 0):
            end = float(np.interp(abs(at[0]), xs, np.asarray(curve.ys)))
            if math.isfinite(end):
                yield Curve("", [at[0], at[0]], [at[1], end], style=RESERVE, dash=SOLID)


def _energy_picture(cycle: CycleStudy) -> Ink | None:
    """Where the energy of a cycle goes; None if none is used."""
    parts = balance_of(cycle)
    if not any(value > 0 for _, value in parts):
        return None
    steps = [WaterfallBar(name, value, value_text(ENERGY, abs(value), 3)) for name, value in parts]
    words = efficiency_of(cycle)
    beside = words if cycle.way == 0 else f"efficiency {words}"
    return waterfall("Energy per cycle", steps, WIDTHS[1], beside=beside)


# ---- the linkage ----


class _Pose(NamedTuple):
    """Points of the linkage in a plane [m]: the joint axis is the origin."""

    pivot: Point
    crank: Point


def _pose_at(linkage: LinkageSize, angle: float) -> _Pose:
    """The linkage at a joint angle [rad]; the fixed pivot lies left of the joint."""
    turned = angle + linkage.angle_offset
    reach = linkage.crank_radius
    return _Pose((-linkage.base_radius, 0.0), (-reach * math.cos(turned), reach * math.sin(turned)))


def _pose(lengths: Mapping[str, float], linkage: LinkageSize, cycle: CycleStudy) -> Ink:
    """The linkage to scale at the least force reserve, and pale at both ends of the cycle."""
    reserve = cycle.worst["reserve"]
    angle = cycle.record.motion
    poses = [_pose_at(linkage, float(x)) for x in (angle.min(), angle.max())]
    worst = _pose_at(linkage, float(angle[reserve.sample]))
    half = lengths["barrel_outer_diameter"] / 2
    spots = [(0.0, 0.0), *(spot for pose in [*poses, worst] for spot in pose)]
    left, right = min(x for x, _ in spots) - half, max(x for x, _ in spots) + half
    low, high = min(y for _, y in spots) - half, max(y for _, y in spots) + half
    paper, real = choose_scale(right - left, high - low, WIDTHS[1], POSE)
    factor = 1000.0 * paper / real
    ink = Ink(WIDTHS[1], (high - low) * factor + 18.0)
    shift = (ink.width - (right - left) * factor) / 2

    def place(point: Point) -> Point:
        return shift + (point[0] - left) * factor, 9.0 + (high - point[1]) * factor

    ink.text(0.0, 4.0, f"Linkage at {time_of(cycle, reserve.sample)}", size=6.8, bold=True)
    arm = value_of(ARM, abs(float(cycle.traces["arm"][reserve.sample])))
    words = f"lever arm {arm} (dashed)"
    ink.text(ink.width, 4.0, words, anchor="right", color=GREY)
    sweep = np.linspace(float(angle.min()), float(angle.max()), 33)
    ink.line(*(place(_pose_at(linkage, float(x)).crank) for x in sweep), stroke=FAINT, pen=0.25)
    for pose in poses:
        ink.line(place(pose.pivot), place(pose.crank), place((0.0, 0.0)), stroke=FAINT, pen=0.25)
    _draw_pose(ink, worst, lengths, linkage, place, factor)
    scale_bar(ink, factor, ink.height - 2.4)
    ink.text(ink.width, ink.height - 2.4, f"SCALE {paper}:{real}", anchor="right", bold=True)
    return ink


def _draw_pose(
    ink: Ink,
    pose: _Pose,
    lengths: Mapping[str, float],
    linkage: LinkageSize,
    place: Callable[[Point], Point],
    factor: float,
) -> None:
    """One pose: base, crank, actuator, lever arm and joints."""
    (px, py), (cx, cy) = pose
    length = math.dist(pose.pivot, pose.crank)
    along = ((cx - px) / length, (cy - py) / length)

    def on(distance: float, aside: float = 0.0) -> Point:
        x = px + distance * along[0] - aside * along[1]
        return place((x, py + distance * along[1] + aside * along[0]))

    eye, extension = lengths.get("eye_offset", 0.0), lengths.get("extension", 0.0)
    end = max(linkage.closed_length - extension - eye, 0.3 * linkage.closed_length)
    start = min(eye, end / 2)
    joint = place((0.0, 0.0))
    ink.line(joint, place(pose.pivot), stroke=GREY, pen=0.35)
    ink.line(joint, place(pose.crank), stroke=BLACK, pen=0.7)
    rod, barrel = lengths["rod"] / 2, lengths["barrel_outer_diameter"] / 2
    for first, last, radius, fill in ((0.0, length, rod, WHITE), (start, end, barrel, "#d5e6f0")):
        corners = [on(first, radius), on(last, radius), on(last, -radius), on(first, -radius)]
        ink.path([corners], closed=True, fill=fill, pen=0.2)
    foot = -(px * along[0] + py * along[1])
    ink.line(joint, on(foot), stroke=BLUE, pen=0.25, dash=(1.2, 0.8))
    if foot > length:
        ink.line(on(length), on(foot), stroke=BLUE, pen=0.13, dash=(1.2, 0.8))
    pin = max(lengths.get("pin", 0.0) / 2 * factor, 0.7)
    for spot in (place(pose.pivot), place(pose.crank), joint):
        ink.circle(*spot, pin, fill=WHITE, pen=0.25)
    below = joint[1] + pin + 2.4
    corner = max(on(start, -barrel)[1], on(start, barrel)[1])  # the halo of a name must not cut it
    for spot, words, y in (
        (place(pose.pivot), "fixed pivot", max(below, corner + 2.2)),
        (joint, "joint", below),
    ):
        ink.text(spot[0], y, words, size=6.0, anchor="center", color=GREY, halo=True)


# ---- temperatures from cold ----


def duration_words(seconds: float) -> str:
    """A time in seconds, minutes or hours.

    >>> duration_words(62.27), duration_words(900.0), duration_words(72000.0)
    ('62.3 s', '15.0 min', '20.0 h')
    """
    unit, factor = _time_unit(seconds)
    return f"{number(factor * seconds, 3)} {unit}"


def _time_unit(seconds: float) -> tuple[str, float]:
    """Unit for times up to this one, and the factor from seconds."""
    if seconds < LONG:
        return "s", 1.0
    return ("min", 1 / 60) if seconds < LONG * 60 else ("h", 1 / 3600)


def warming_name(warming: Warming) -> str:
    """The cycle under which the actuator warms up, or "mean of all cycles"."""
    return clean(warming.name)


def nearest(warming: Warming) -> WarmingPlace:
    """The place nearest to its limit when steady; the hottest where no limit is known."""
    limited = [place for place in warming.places if place.limit is not None]
    if not limited:
        return max(warming.places, key=lambda place: place.steady)
    return min(limited, key=lambda place: (place.limit or 0.0) - place.steady)


def warming_chart(study: DutyStudy, note: str) -> Chart:
    """Temperatures of oil, wall and rod from cold; a panel for each cycle with little reserve."""
    ranked = sorted(study.warming, key=lambda warming: warming.reserve)[:MOST_PANELS]
    shown = [warming for warming in study.warming if any(warming is x for x in ranked)]
    panels = [_warming_panel(warming) for warming in shown]
    worst = ranked[0]
    place = nearest(worst)
    span = float(worst.time[-1])
    level = None if place.limit is None else TEMPERATURE.to_display(place.limit)
    figure = TerminalFigure(
        f"{warming_name(worst)}: {clean(place.name)} from cold, {unit_text(TEMPERATURE.unit)}",
        list(zip(worst.time.tolist(), _shown(place.temperature).tolist(), strict=True)),
        level,
        ("0", duration_words(span)),
    )
    key = [Curve(words, [], [], style=k) for k, (words, _) in enumerate(_curves_of(worst))]
    return Chart(WARMING_TITLE, panels, note, instead=figure, height=58.0, key=key)


def _shown(kelvin: Array) -> Array:
    """Temperatures in the unit of figures."""
    return np.array([TEMPERATURE.to_display(float(value)) for value in kelvin])


def _warming_panel(warming: Warming) -> Panel:
    """Temperatures under one cycle, their limits, and when they exceed them."""
    unit, factor = _time_unit(float(warming.time[-1]))
    time = factor * warming.time
    places = _curves_of(warming)
    curves = [
        Curve("", time, _shown(place.temperature), style=k) for k, (_, place) in enumerate(places)
    ]
    start = TEMPERATURE.to_display(warming.start)
    highest = max(float(np.max(curve.ys)) for curve in curves)
    limits = dict.fromkeys(place.limit for place in warming.places if place.limit is not None)
    levels = [
        Level(TEMPERATURE.to_display(limit), limit_text(TEMPERATURE, "max", limit), "max")
        for limit in limits
        if TEMPERATURE.to_display(limit) - start <= NEAR * (highest - start)
    ]
    if warming.mission is not None and warming.mission < warming.time[-1]:
        end = factor * warming.mission
        levels.append(Level(end, "end of the mission", style=RESERVE, upright=True))
    crossings = {
        (place.crossed, place.limit)
        for place in warming.places
        if place.limit is not None and place.crossed is not None
        if place.crossed <= warming.time[-1]
    }
    points = [
        Points(
            "",
            [factor * crossed],
            [TEMPERATURE.to_display(limit)],
            style=FILLED,
            labels=[duration_words(crossed)],
        )
        for crossed, limit in sorted(crossings)
    ]
    return Panel(
        f"{warming_name(warming)}: temperature, {unit_text(TEMPERATURE.unit)}",
        Axis(f"time, {unit}", range=(0.0, float(time[-1]))),
        Axis(range=even_range([start, highest, *(x.value for x in levels if not x.upright)])),
        curves=curves,
        points=points,
        levels=levels,
    )


def _curves_of(warming: Warming) -> list[tuple[str, WarmingPlace]]:
    """Curves of a panel with their names: oil, rod, innermost layer, and the layer worst off."""
    places = {place.name: place for place in warming.places}
    layers = [place for place in warming.places if place.name.startswith("layer ")]
    limited = [place for place in layers if place.limit is not None]
    worst = min(limited, key=lambda p: (p.limit or 0.0) - p.steady, default=layers[0])
    chosen = [("oil", places["oil"]), ("rod and its seals", places["rod seal"])]
    for layer in dict.fromkeys((layers[0].name, worst.name)):
        seals = " and the piston's seals" if layer == layers[0].name else ""
        chosen.append((f"inside of {clean(layer)}{seals}", places[layer]))
    return chosen
