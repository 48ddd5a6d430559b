"""Doubts about duty cycles: too fast for the quasi-static model, or too short for a seal."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from ...base.numeric import over_travel
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
    "duty_power_peak",
    "duty_power_absorbed",
)
"""Metrics that a quasi-static model gets wrong when a cycle is too fast."""
LEAKING = 0.1
"""Share of the flow that leaks, from which it shifts the pressures (our choice: a tenth of the flow
is a fifth of a pressure drop)."""
LOWEST = ("duty_pressure_min", "duty_suction_ratio")
"""Metrics of the lowest pressure."""
HIGHEST = ("duty_pressure_max",)
"""Metrics of the highest pressure."""
OPENED = ("duty_opening",)
"""Metrics of the largest opening."""
RUBBING = ("duty_friction_energy", "duty_seal_temperature", "duty_temperature_margin")
"""Metrics that follow from the friction of the seals."""


def warnings(
    study: DutyStudy, frequencies: Mapping[str, float], *, valve: bool
) -> Iterator[tuple[str, str]]:
    """Yield (metric, sentence) for every cycle on which the quasi-static model is doubtful.

    It is too fast, or its lowest pressure occurs where the valve leaks more than the piston takes,
    or its seals have an oil film, whose friction the model does not compute.

    Parameters
    ----------
    study : the duty cycles of a design
    frequencies : natural frequency, bandwidth and so on in words, each with its value [Hz]
    valve : whether the design has a valve, which a simulation needs
    """
    for cycle in study.cycles:
        yield from _at_leakage(cycle, valve=valve)
        yield from _dry_friction(cycle, study.films)
    known = {words: value for words, value in frequencies.items() if value > 0}
    if not known:
        return
    lowest = min(known, key=lambda words: known[words])
    text = INPUTS["frequency"].text
    for cycle in study.cycles:
        content = content_frequency(cycle)
        if content <= SLOW * known[lowest]:
            continue
        run = _simulation(cycle)
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


def _simulation(cycle: CycleStudy) -> str:
    """The command that simulates a cycle."""
    name = cycle.name if cycle.name.isalnum() else f"'{cycle.name}'"
    return f"actuator-opt simulate FILE --cycle {name}"


def _at_leakage(cycle: CycleStudy, *, valve: bool) -> Iterator[tuple[str, str]]:
    """Warn if the valve leaks much of the flow at an extreme pressure or at the largest opening."""
    if not valve or not cycle.worst:
        return
    traces, text = cycle.traces, INPUTS["pressure"].text
    low, high = (f(traces["pressure_a"], traces["pressure_b"]) for f in (np.minimum, np.maximum))
    affected: list[str] = []
    places: list[str] = []
    for metrics, sample, words in (
        (LOWEST, np.argmin(low), f"at the lowest pressure, {text(float(low.min()), 3)}"),
        (HIGHEST, np.argmax(high), f"at the highest pressure, {text(float(high.max()), 3)}"),
        (OPENED, np.argmax(traces["opening"]), "at the largest opening"),
    ):
        leakage, flow = (float(traces[key][sample]) for key in ("leakage", "flow"))
        if leakage > LEAKING * flow:
            affected += metrics
            share, time = 100 * leakage / flow, cycle.record.time[sample]
            of_flow = "" if places else " of the flow"
            places.append(f"{share:.0f} %{of_flow} {words} ({time:.3g} s)")
    for metric in affected:
        yield (
            metric,
            f"{cycle.name}: leakage takes {', '.join(places)}; it brings the pressures of both "
            "chambers closer together and opens the valve further, which these results leave out: "
            f"run {_simulation(cycle)}",
        )


def _dry_friction(cycle: CycleStudy, films: Mapping[str, str]) -> Iterator[tuple[str, str]]:
    """Warn of friction of seals with an oil film, which is computed as that of dry contact."""
    total = cycle.energies.get("friction_energy", 0.0)
    if not films or not total > 0:
        return
    x = cycle.traces["position"]
    dry = sum(float(over_travel(cycle.traces[trace], x)) for trace in films.values())
    for metric in RUBBING:
        yield (
            metric,
            f"{cycle.name}: {' and '.join(films)} with an oil film: friction along a duty cycle is "
            "that of dry contact with the friction coefficient of the seal, "
            f"{100 * dry / total:.0f} % of the friction energy",
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
