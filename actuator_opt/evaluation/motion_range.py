"""Range of the linear model: sticking, oscillating and stalled loads, long lines."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from ..base.numeric import Array
from ..design.model import Design
from .motion import Motion
from .rows import MetricArrays
from .springs import weakest_per_chamber
from .state import LoadState
from .values import Values

LEAST_DAMPING = 0.005
"""Damping ratio below which a loop counts as poorly damped (choice)."""
NEAR_RESONANCE = 0.8
"""Bandwidth over natural frequency of the load that counts as close to it (choice)."""
LONGEST = 0.1
"""Largest line length of a chamber over wavelength for a lumped element (choice: 3 % error of the
admittance of a closed line, 7 % at constant end pressure)."""


def warnings(
    v: Values, design: Design, motion: Motion, state: LoadState, out: MetricArrays
) -> Iterable[tuple[str, str]]:
    """(metric, sentence) for each use of the linear model outside its range."""
    slowest = float(np.min(np.real(motion.damping)))
    if slowest < 0:
        yield (
            "damping_ratio",
            f"friction falls with speed ({slowest:.3g} N*s/m): stick-slip is possible",
        )
    if "ultimate_gain" in out.metrics:
        yield from _loop(v, motion, out)
        own = design.valve
        if own is not None and own.tank_leakage_drop not in (None, own.leakage_drop):
            yield (
                "ultimate_gain",
                "tank edges and supply edges leak differently: the holding pressures assume equal "
                "edges; a scenario computes its own",
            )
    yield from _ports(v, design, motion, state)
    yield from _lines(design, motion, out)


def _weakest_gain(motion: Motion) -> Array:
    """Smallest flow gain of the valve over chambers and directions, in every case."""
    assert motion.valve is not None
    gains = [np.abs(np.real(gain)) for ways in motion.valve.gains.values() for gain in ways]
    return np.min(np.stack(np.broadcast_arrays(*gains)), axis=0)


def _loop(v: Values, motion: Motion, out: MetricArrays) -> Iterable[tuple[str, str]]:
    """The position loop is unstable, poorly damped, beyond its resonance, or without drive."""
    damped = min(float(np.min(np.real(x))) for x in out.metrics["damping_ratio"].values())
    if 0 <= damped < LEAST_DAMPING:
        yield (
            "damping_ratio",
            f"the load has almost no damping (ratio {damped:.1g}): its loop must be slow; "
            "state valve.leakage_flow with ports.end: valve, or piston.leakage_conductance",
        )
    weakest = weakest_per_chamber(motion.springs)
    resonance = float(np.min(np.real(motion.closed_frequency(weakest))))
    widths = [float(np.max(np.real(x))) for x in out.metrics["bandwidth"].values()]
    near = sum(width > NEAR_RESONANCE * resonance for width in widths)
    if near:
        yield (
            "bandwidth",
            f"at {near} of {len(widths)} places the closed loop falls to -3 dB only at or "
            "above the "
            "load resonance: there it oscillates and does not follow the signal",
        )
    least = min(float(np.min(np.real(x))) for x in out.metrics["ultimate_gain"].values())
    margin = min(float(np.min(np.real(x))) for x in out.metrics["gain_margin"].values())
    if least > 0 and margin <= 1:
        yield "bandwidth", "the position loop is unstable at this gain: its bandwidth counts as 0"
    stalled = [
        case
        for case, gain in zip(
            v.cases, np.broadcast_to(_weakest_gain(motion), (len(v.cases), 1)), strict=True
        )
        if gain[0] == 0
    ]
    for case in stalled:
        yield (
            "bandwidth",
            f"{case}: the held force needs the whole supply pressure, the valve has no effect",
        )
    if least == 0:
        yield (
            "ultimate_gain",
            "no gain is stable: the load itself is unstable, or leakage across the piston "
            "exceeds that of the valve; add valve leakage or load damping",
        )


def _ports(
    v: Values, design: Design, motion: Motion, state: LoadState
) -> Iterable[tuple[str, str]]:
    """Line ends with less effect than expected."""
    if design.valve is not None and design.ports.end == "closed":
        for metric in ("damping_ratio", "dynamic_stiffness"):
            yield (
                metric,
                "ports.end is closed: damping ratio and dynamic stiffness exclude the leakage of "
                "the holding valve; write end: valve to include it",
            )
    slow = np.ravel(np.real(state.speed)) == 0
    shaken = [case.frequency is not None for case in design.load_cases]
    if motion.throttles and np.any(slow & np.array(shaken)):
        yield (
            "dynamic_stiffness",
            "a throttle in a case with excitation but no speed: taken at creeping flow",
        )
    for i, one in enumerate(design.ports.accumulators):
        held = state.holding_a if one.chamber == "a" else state.holding_b
        precharge = float(np.max(np.real(v[f"ports.accumulators[{i}].precharge"])))
        if float(np.min(np.real(held))) <= precharge:
            yield (
                "",
                f"ports.accumulators[{i}]: its precharge is not below the holding pressure in "
                "every case: it takes no oil there",
            )


def _lines(design: Design, motion: Motion, out: MetricArrays) -> Iterable[tuple[str, str]]:
    """Lines too long for a lumped element at the frequencies of interest."""
    asked = {f"load case {case.name}": case.frequency or 0.0 for case in design.load_cases}
    if motion.spool is not None:
        asked["the valve's spool"] = float(np.max(np.real(motion.spool[0])))
    what, fastest = max(asked.items(), key=lambda one: one[1])
    for place, resonance in out.metrics.get("line_resonance", {}).items():
        limit = 4 * LONGEST * float(np.min(np.real(resonance)))
        if fastest > limit:
            metric = "dynamic_stiffness" if "dynamic_stiffness" in out.metrics else "bandwidth"
            yield (
                metric,
                f"{place}: a single lumped element, valid to {limit:.0f} Hz, but {what} has "
                f"{fastest:.4g} Hz: the result is rough, the report compares it with transmission "
                "lines",
            )
