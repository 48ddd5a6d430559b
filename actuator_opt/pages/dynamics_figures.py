"""Figures of the dynamics: modes along the stroke, dynamic stiffness and position loop.

Requirements are drawn in red, and their forbidden side is hatched.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ..base.dataclass import dataclass
from ..base.numeric import Array
from ..evaluation.dynamics_study import DynamicsStudy, LoopStudy, Response
from ..evaluation.result import Requirement
from ..rendering.chart import Axis, Curve, Level, Panel, Points
from ..rendering.text import MINUS, SENSES, SUPERSCRIPTS, number, trimmed

DEEPEST = 1000.0
"""Ratio of the static stiffness to the lowest stiffness that is drawn."""
MOST_CASES = 6
"""Largest number of load cases with excitation that are named above the figure."""
STATIC, SHAKEN, BASE, MARGIN = 5, 5, 4, 4
"""Styles of lines: static stiffness, excitation frequency of a load case, base line of a margin
(0 dB or -180 degrees), and the margin itself."""
OPEN, FILLED, PALE = 2, 3, 1
"""Styles of points: ochre, blue, and light blue with a black edge."""
REACH = 1.25
"""A limit that applies at a single frequency is drawn from this frequency divided by `REACH` to
this frequency times `REACH`."""
ALONG = "piston position from the cap end, mm"


@dataclass(frozen=True, slots=True)
class Shaken:
    """A load case with excitation: frequency (Hz), least dynamic stiffness (N/m), phase (rad)."""

    name: str
    frequency: float
    stiffness: float | None = None
    phase: float | None = None


def frequency_axis(study: DynamicsStudy, label: str = "frequency, Hz") -> Axis:
    """The frequency axis of a study."""
    ends = float(study.frequencies[0]), float(study.frequencies[-1])
    return Axis(label, log=True, range=ends)


def limit_level(row: Requirement, value: float, unit: str = "") -> Level:
    """A requirement as a limit line at `value` on the axis."""
    words = f"{SENSES[row.sense]} {trimmed(value)}{unit}"
    return Level(value, words, "min" if row.sense == "min" else "max")


def minimum(x: float, y: float) -> Points:
    """A mark at the lowest point of a curve over the stroke (x in mm), labelled with its value."""
    words = f"minimum {number(y)} at {trimmed(x, 3)} mm"
    return Points("", [x], [y], style=FILLED, labels=[words])


# ---- along the stroke ----


def _frequency_panel(study: DynamicsStudy, requirements: Sequence[Requirement]) -> Panel:
    """Natural frequency along the stroke: with closed ports, and with the hydraulic lines."""
    xs = [1000.0 * float(x) for x in study.position]
    closed = [float(f) for f in study.closed_frequency]
    ended = [float(f) for f in study.frequency]
    both = any(abs(a - b) > 1e-3 * b for a, b in zip(ended, closed, strict=True))
    curves = [Curve("ports closed" if both else "", xs, closed)]
    if both:
        end = study.end.replace("_", " ")
        words = (
            "including the moving oil in the lines"
            if study.end == "closed"
            else f"oil lines end at: {end}"
        )
        curves.append(Curve(words, xs, ended))
    least = min(closed)
    floor = max([least, *(row.limit for row in requirements), *([min(ended)] if both else [])])
    shown = [f for f in (*closed, *(ended if both else ())) if math.isfinite(f)]
    top = 1.06 * min(max([*shown, 1.15 * floor]), 3.0 * floor)
    return Panel(
        "Natural frequency, Hz",
        Axis(ALONG, range=(xs[0], xs[-1])),
        Axis(range=(0.0, top)),
        curves=curves,
        points=[minimum(xs[closed.index(least)], least)],
        levels=[limit_level(row, row.limit) for row in requirements],
    )


def _damping_panel(study: DynamicsStudy, requirements: Sequence[Requirement]) -> Panel:
    """Damping ratio along the stroke, and the part due to friction at the weakest position."""
    xs = [1000.0 * float(x) for x in study.position]
    ratios = np.asarray(study.damping_ratio, dtype=float)
    finite = ratios[np.isfinite(ratios)]
    size = max([abs(study.friction_share), *np.abs(finite).tolist()])
    power = 0 if size == 0 else 3 * min(0, math.floor(math.log10(size) / 3 + 1 / 3))
    scale = 10.0**-power
    unit = "" if power == 0 else f", 10{str(power).translate(SUPERSCRIPTS)}"
    weakest = int(np.argmin(study.closed_frequency))
    levels = [replace(limit_level(row, row.limit), value=scale * row.limit) for row in requirements]
    values = [*(scale * finite).tolist(), scale * study.friction_share, 0.0]
    largest = 4 * max(map(abs, values))
    values += [level.value for level in levels if level.value < largest]
    return Panel(
        f"Damping ratio{unit}",
        Axis(ALONG, range=(xs[0], xs[-1])),
        Axis(range=(1.08 * min(values), 1.08 * max(values) or 1.0)),
        curves=[Curve("", xs, scale * ratios)],
        points=[
            Points("", [xs[weakest]], [scale * study.friction_share], style=OPEN),
            Points("", [xs[weakest]], [scale * float(ratios[weakest])], style=FILLED),
        ],
        levels=levels,
    )


def modes_panels(
    study: DynamicsStudy, frequency: Sequence[Requirement], damping: Sequence[Requirement]
) -> list[Panel]:
    """Natural frequency and damping ratio along the stroke."""
    return [_frequency_panel(study, frequency), _damping_panel(study, damping)]


# ---- over frequency ----


def _stiffness_range(responses: Sequence[Response], shown: Sequence[float]) -> tuple[float, float]:
    """Range of the axis (kN/mm); it ends at a thousandth of the static stiffness."""
    statics = [response.static / 1e6 for response in responses]
    values = [float(v) / 1e6 for response in responses for v in response.magnitude if v > 0]
    low = max(min([*values, *statics]), min(statics) / DEEPEST)
    return min([low, *shown]) / 1.4, 1.4 * max([*values, *statics, *shown])


def magnitude_panel(
    study: DynamicsStudy, shaken: Sequence[Shaken], requirements: Sequence[Requirement]
) -> Panel:
    """Magnitude of the dynamic stiffness at three stroke positions, with the static stiffness."""
    cases = list(zip("abcdef", shaken[:MOST_CASES], strict=False))
    results = [case.stiffness / 1e6 for case in shaken if case.stiffness]
    limits = [row.limit / 1e6 for row in requirements if shaken and row.limit > 0]
    ends = _stiffness_range(study.responses, [*results, *limits])
    words = "static" if not shaken else "static, ports closed"
    levels = [Level(response.static / 1e6, words, style=STATIC) for response in study.responses]
    for k, case in enumerate(shaken):
        levels += _limits_at(case.frequency, requirements, 1e-6, "" if k else " kN/mm")
    return Panel(
        "Magnitude, load mass included, kN/mm",
        frequency_axis(study, ""),
        Axis(log=True, range=ends),
        curves=[
            Curve(
                f"{response.place}, {trimmed(1e3 * response.position, 3)} mm:"
                f" static {number(response.static / 1e6)}",
                study.frequencies,
                response.magnitude / 1e6,
            )
            for response in study.responses
        ],
        points=[_case_points(letter, case) for letter, case in cases],
        levels=levels,
        note=f"and {len(shaken) - MOST_CASES} more load cases" if len(shaken) > MOST_CASES else "",
        share=0.6,
    )


def _case_points(letter: str, case: Shaken) -> Points:
    """The result of a load case as a point with a legend entry."""
    words = [f"{letter}: {case.name}", f"{trimmed(case.frequency)} Hz"]
    if case.phase is not None:
        words.append(f"{number(math.degrees(case.phase), 3)}°")
    if not case.stiffness:
        return Points(", ".join(words), [], [], style=PALE)
    stiffness = case.stiffness / 1e6
    words.insert(2, f"{number(stiffness)} kN/mm")
    return Points(", ".join(words), [case.frequency], [stiffness], style=PALE, labels=[letter])


def _limits_at(
    frequency: float, requirements: Sequence[Requirement], scale: float, unit: str
) -> list[Level]:
    """The limits that apply at a frequency, with a vertical line; labelled if `unit` is given."""
    levels = [Level(frequency, "", style=SHAKEN, upright=True)]
    for row in requirements:
        level = limit_level(row, scale * row.limit, unit)
        ends = (frequency / REACH, frequency * REACH)
        levels.append(replace(level, between=ends, words=level.words if unit else ""))
    return levels


def _phase_panel(
    study: DynamicsStudy, shaken: Sequence[Shaken], requirements: Sequence[Requirement]
) -> Panel:
    """Phase of the dynamic stiffness at three stroke positions."""
    curves = [np.degrees(response.phase) for response in study.responses]
    low = -180.0 if min(float(np.min(curve)) for curve in curves) < -1.0 else 0.0
    levels: list[Level] = []
    for k, case in enumerate(shaken):
        levels += _limits_at(case.frequency, requirements, math.degrees(1.0), "" if k else "°")
    return Panel(
        "Phase lead of the force over the motion, °",
        frequency_axis(study),
        Axis(
            range=(low, 180.0),
            ticks=[(v, whole(v)) for v in range(int(low), 181, 45 if low == 0 else 90)],
        ),
        curves=[Curve("", study.frequencies, curve) for curve in curves],
        points=[
            Points("", [case.frequency], [math.degrees(case.phase)], style=PALE, labels=[letter])
            for letter, case in zip("abcdef", shaken[:MOST_CASES], strict=False)
            if case.phase is not None
        ],
        levels=levels,
        share=0.4,
    )


def whole(value: float) -> str:
    """A number as the label of an axis, rounded to a whole number."""
    return f"{value:.0f}".replace("-", MINUS)


def response_panels(
    study: DynamicsStudy,
    shaken: Sequence[Shaken],
    stiffness: Sequence[Requirement],
    phase: Sequence[Requirement],
) -> list[Panel]:
    """Dynamic stiffness: the magnitude, and below it the phase."""
    return [magnitude_panel(study, shaken, stiffness), _phase_panel(study, shaken, phase)]


def compact_panels(
    study: DynamicsStudy, frequency: Sequence[Requirement], damping: Sequence[Requirement]
) -> list[Panel]:
    """Natural frequency, damping ratio and dynamic stiffness side by side."""
    panel = magnitude_panel(study, (), ())
    named = zip(panel.curves, study.responses, strict=True)
    curves = [replace(curve, words=response.place) for curve, response in named]
    title = "Dynamic stiffness, kN/mm"
    magnitude = replace(panel, title=title, x=frequency_axis(study), curves=curves, share=1.0)
    return [*modes_panels(study, frequency, damping), magnitude]


# ---- the position loop ----

HALF_POWER = -10 * math.log10(2.0)
"""-3 dB, where a closed loop's bandwidth ends."""


@dataclass(frozen=True, slots=True)
class LoopLimits:
    """Requirements on the position loop: gain margin, phase margin and bandwidth."""

    gain_margin: Sequence[Requirement] = ()
    phase_margin: Sequence[Requirement] = ()
    bandwidth: Sequence[Requirement] = ()


def decibels(ratio: Array | float) -> Array:
    """A ratio of magnitudes in dB.

    >>> decibels(np.array([10.0, 0.0])).tolist()
    [20.0, -6000.0]
    """
    return np.asarray(20 * np.log10(np.maximum(ratio, 1e-300)))


def governing(loops: Sequence[LoopStudy], figure: str) -> int:
    """Index of the loop with the smallest margin or bandwidth; loops without a value come last."""

    def least(k: int) -> float:
        value = getattr(loops[k], figure)
        return math.inf if value is None or math.isnan(value) else float(value)

    return min(range(len(loops)), key=least)


def open_panels(
    study: DynamicsStudy, loops: Sequence[LoopStudy], limits: LoopLimits
) -> list[Panel]:
    """Open loop: the magnitude, below it the phase; the least gain and phase margins are marked."""
    return [
        _loop_magnitude_panel(study, loops, limits.gain_margin),
        _loop_phase_panel(study, loops, limits.phase_margin),
    ]


def _loop_curves(study: DynamicsStudy, loops: Sequence[LoopStudy], values: str) -> list[Curve]:
    """Magnitudes of all loops in dB, named by load case, direction and stroke position."""
    return [
        Curve(f"{loop.case}, {loop.place}", study.frequencies, decibels(getattr(loop, values)))
        for loop in loops
    ]


def _decibel_axis(low: float, high: float) -> Axis:
    """A dB axis with ticks every 20 dB, or every 10 or 5 dB if the range is short."""
    step = 20 if high - low > 50 else 10 if high - low > 25 else 5
    levels = range(step * math.ceil(low / step), math.floor(high) + 1, step)
    return Axis(range=(low, high), ticks=[(level, whole(level)) for level in levels])


def _margin(frequency: float, base: float, end: float, words: str) -> tuple[Curve, Points]:
    """A margin as a line from its base (0 dB or -180 degrees) to the curve, with its label."""
    return (
        Curve("", [frequency, frequency], [base, end], style=MARGIN, dash=0),
        Points("", [frequency], [end], style=PALE, labels=[words]),
    )


def _loop_magnitude_panel(
    study: DynamicsStudy, loops: Sequence[LoopStudy], requirements: Sequence[Requirement]
) -> Panel:
    curves = _loop_curves(study, loops, "open_magnitude")
    loop = loops[governing(loops, "gain_margin")]
    known = 0 < loop.gain_margin < math.inf
    margin = float(decibels(loop.gain_margin)) if known else 0.0
    limits = [-float(decibels(row.limit)) for row in requirements]
    low = min([-40.0, -margin - 15.0, *(limit - 5.0 for limit in limits)])
    low = max(low, min(float(np.min(curve.ys)) for curve in curves) - 5.0, -140.0)
    high = max(20.0, *(float(np.max(curve.ys)) for curve in curves), -margin + 5.0)
    points, levels, note = [], [], ""
    if loop.gain_margin == math.inf:
        note = "The loop is stable at any gain."
    elif loop.gain_margin <= 0:
        note = "The loop is unstable at any gain."
    elif loop.gain_margin < 1:
        note = "The closed loop is unstable."
    frequency = loop.ultimate_frequency
    if known and frequency > 0:
        words = f"gain margin {number(loop.gain_margin, 4)} ({_signed(margin)} dB)"
        line, point = _margin(frequency, 0.0, -margin, f"{words} at {number(frequency)} Hz")
        curves.append(line)
        points.append(point)
        levels = [
            Level(
                limit,
                f"{SENSES[row.sense]} {trimmed(row.limit)}",
                "max" if row.sense == "min" else "min",
                between=(frequency / REACH, frequency * REACH),
            )
            for row, limit in zip(requirements, limits, strict=True)
        ]
    return Panel(
        "Open loop, magnitude, dB",
        frequency_axis(study, ""),
        _decibel_axis(low, min(high, 120.0) + 3.0),
        curves=curves,
        points=points,
        levels=levels,
        note=note,
    )


def _loop_phase_panel(
    study: DynamicsStudy, loops: Sequence[LoopStudy], requirements: Sequence[Requirement]
) -> Panel:
    phases = [np.degrees(loop.open_phase) for loop in loops]
    index = governing(loops, "phase_margin")
    loop = loops[index]
    lowest = min(float(np.min(phase)) for phase in phases)
    highest = max(float(np.max(phase)) for phase in phases)
    low, high = min(lowest, -180.0) - 15.0, max(highest, -90.0) + 15.0
    step = 90 * max(1, math.ceil((high - low) / 630.0))
    ticks = [(float(v), whole(v)) for v in range(-1800, 1801, step) if low <= v <= high]
    turns = range(int(-high // 360) - 1, int(-low // 360) + 2)
    levels = [Level(-180.0 - 360.0 * turn, "", style=BASE) for turn in turns]
    levels = [level for level in levels if low <= level.value <= high]
    curves = [Curve("", study.frequencies, phase) for phase in phases]
    points, note = [], ""
    if loop.crossover is None or math.isnan(loop.phase_margin):
        note = "The magnitude does not cross 0 dB."
    else:
        x = math.log10(loop.crossover)
        phase = float(np.interp(x, np.log10(study.frequencies), phases[index]))
        base = -180.0 - 360.0 * round(-(phase + 180.0) / 360.0)
        words = f"phase margin {number(math.degrees(loop.phase_margin))}°"
        line, point = _margin(
            loop.crossover, base, phase, f"{words} at {number(loop.crossover)} Hz"
        )
        curves.append(line)
        points.append(point)
        side = 1.0 if phase >= base or loop.phase_margin < 0 else -1.0
        levels += [
            Level(
                base + side * math.degrees(row.limit),
                f"{SENSES[row.sense]} {trimmed(math.degrees(row.limit))}°",
                "min" if (side > 0) == (row.sense == "min") else "max",
                between=(loop.crossover / REACH, loop.crossover * REACH),
            )
            for row in requirements
        ]
    return Panel(
        "Open loop, phase, °",
        frequency_axis(study),
        Axis(range=(low, high), ticks=ticks),
        curves=curves,
        points=points,
        levels=levels,
        note=note,
    )


def closed_panel(study: DynamicsStudy, loops: Sequence[LoopStudy], limits: LoopLimits) -> Panel:
    """Closed loop with the bandwidth of every curve."""
    curves = _loop_curves(study, loops, "closed_magnitude")
    highest = max(float(np.max(curve.ys)) for curve in curves)
    least = governing(loops, "bandwidth")
    points = [
        Points(
            "",
            [loop.bandwidth],
            [HALF_POWER],
            style=2 * k,
            labels=[f"bandwidth {number(loop.bandwidth)} Hz" if k == least else ""],
        )
        for k, loop in enumerate(loops)
        if loop.bandwidth is not None
    ]
    levels = [Level(HALF_POWER, f"{MINUS}3 dB", style=STATIC)]
    for row in limits.bandwidth:
        if row.limit > 0:
            levels.append(replace(limit_level(row, row.limit, " Hz"), upright=True))
    notes = []
    if loops[governing(loops, "gain_margin")].gain_margin < 1:
        notes.append("The closed loop is unstable, so these curves are not its response.")
    if loops[least].bandwidth is None:
        notes.append("No bandwidth.")
    return Panel(
        "Closed loop, magnitude, dB",
        frequency_axis(study),
        _decibel_axis(-40.0, min(max(highest, 0.0), 60.0) + 5.0),
        curves=curves,
        points=points,
        levels=levels,
        note=" ".join(notes),
    )


def _signed(value: float) -> str:
    return f"{value:.1f}".replace("-", MINUS)
