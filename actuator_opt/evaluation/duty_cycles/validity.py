"""Doubts about duty cycles: too fast for the quasi-static model, or too short for a seal."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from ...base.quantities import INPUTS
from ...design.cycle_record import spline
from ...models import wear
from .study import CycleStudy, DutyStudy

POWER = 0.99
"""Share of the power of the speed that lies below the frequency of a cycle (our choice)."""
SLOW = 1 / 3
"""Largest frequency of a cycle divided by the lowest frequency of the actuator (our choice: at a
third, a resonance without damping amplifies by 1/(1 - 1/9), 12 %)."""
SAMPLES = 4096
"""Least number of samples for the spectrum (our choice)."""
AFFECTED = (
    "duty_supply_share",
    "duty_supply_needed",
    "duty_force_margin",
    "duty_opening",
    "duty_pressure_min",
    "duty_pressure_max",
    "duty_suction_ratio",
    "duty_flow_peak",
)
"""Metrics that a quasi-static model gets wrong when a cycle is too fast."""


def warnings(
    study: DutyStudy, frequencies: Mapping[str, float], *, valve: bool
) -> Iterator[tuple[str, str]]:
    """Yield (metric, sentence) for every cycle that is too fast for the quasi-static model.

    Parameters
    ----------
    study : the duty cycles of a design
    frequencies : natural frequency, bandwidth and so on in words, each with its value [Hz]
    valve : whether the design has a valve, which a simulation needs
    """
    known = {words: value for words, value in frequencies.items() if value > 0}
    if not known:
        return
    lowest = min(known, key=lambda words: known[words])
    text = INPUTS["frequency"].text
    for cycle in study.cycles:
        content = content_frequency(cycle)
        if content <= SLOW * known[lowest]:
            continue
        run = f"actuator-opt simulate FILE --cycle '{cycle.name}'"
        if cycle.name.isalnum():
            run = run.replace("'", "")
        remedy = f"run {run}" if valve else f"add valve and run {run}"
        for metric in AFFECTED:
            yield (
                metric,
                f"{cycle.name} is too fast to count as quasi-static: {100 * POWER:g} % of the "
                f"power of its speed lies below {text(content, 3)}, which exceeds a third of the "
                f"{lowest} ({text(known[lowest], 3)}): {remedy}",
            )


def short_strokes(study: DutyStudy) -> Iterator[tuple[str, str]]:
    """Yield (metric, sentence) for every seal that short strokes starve of oil."""
    length = INPUTS["length"]
    for cycle in study.cycles:
        for seal, short in cycle.short_strokes.items():
            if not short.strokes:
                continue
            yield (
                "duty_wear",
                f"{cycle.name}: {short.strokes} of {cycle.reversals} strokes are shorter than "
                f"{wear.SHORT_STROKE:g} contact widths of the {seal} "
                f"({length.text(short.shorter_than, 3)}): they carry no fresh oil into the "
                "contact, and the wear law does not show this; if they are noise, smooth the file",
            )


def content_frequency(cycle: CycleStudy) -> float:
    """Frequency below which 99 % of the power of the piston's speed lies [Hz].

    The speed is the slope of the C2 cubic spline through the positions. Its power is that of its
    Fourier series; an open cycle is continued by its mirror image, so that it repeats without a
    jump. Zero if nothing moves.
    """
    time, position = cycle.time - cycle.time[0], cycle.traces["position"]
    if not np.isfinite(position).all() or not np.ptp(position):
        return 0.0
    period, count = float(time[-1]), max(SAMPLES, 4 * time.size)
    closed = cycle.record.closed
    if closed:
        position = np.append(position[:-1], position[0])
    grid = period * (np.arange(count) + (0.0 if closed else 0.5)) / count
    speed = spline(time, position, closed=closed)(grid, 1)
    if not closed:
        speed, period = np.concatenate([speed, speed[::-1]]), 2 * period
    power = np.abs(np.fft.rfft(speed)) ** 2
    total = np.cumsum(power)
    return float(np.searchsorted(total, POWER * total[-1])) / period
