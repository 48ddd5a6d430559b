"""Integration in time, restarted where an input jumps or a switch changes state."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Final

import numpy as np

from ..base.errors import Diagnostic, InputError
from ..base.numeric import Array
from ..base.progress import tell
from .methods import CHUNK, MOST, RELATIVE, Advance, Method, Stuck, lsoda, radau
from .system import Compiled

LOOK = 2e-3
"""Longest time between two samples of a switch [s] (a choice: half an oil oscillation)."""
MOST_TURNS = 20_000
"""Changes of a switch before a run counts as chattering (a choice)."""
APART = 1e-9
"""Instants closer than this count as one [s] (a choice)."""
FEW = 2_000
"""Steps between two samples of a first attempt, which may overrun a switch."""
TRIES = 12
"""Number of ever shorter sections tried where the equations fail, to find a switch before."""
PARTS, LEVELS = 16, 5
"""Parts of an interval in which a switch may change; each is divided again."""
_LOCATED = 1e-12


@dataclass(frozen=True, slots=True)
class Event:
    """A switch that changed state."""

    name: str
    time: float
    on: bool


@dataclass(slots=True)
class Trajectory:
    """States at samples; an instant or event appears twice, with the flags before and after it."""

    time: Array
    states: Array
    """(states, samples)"""
    flags: Array
    """(flags, samples)"""
    events: tuple[Event, ...] = ()
    evaluations: int = 0
    restarts: int = 0


@dataclass(slots=True)
class _Run:
    compiled: Compiled
    advance: Advance
    duration: float
    time: list[Array] = field(default_factory=list)
    states: list[Array] = field(default_factory=list)
    flags: list[Array] = field(default_factory=list)
    events: list[Event] = field(default_factory=list)
    restarts: int = 0

    def keep(self, time: Array, states: Array, m: tuple[bool, ...]) -> None:
        self.time.append(time)
        self.states.append(states)
        self.flags.append(np.repeat(np.array(m, dtype=bool)[:, None], len(time), axis=1))


def integrate(
    compiled: Compiled,
    *,
    duration: float,
    sample_time: float,
    method: Method = "lsoda",
    relative: float | None = None,
) -> Trajectory:
    """Integrate the states over time.

    Parameters
    ----------
    compiled : the equations
    duration : simulated time [s]
    sample_time : of the result [s]; the method chooses its own internal steps
    method : "lsoda", "radau" or "cvodes" (extra ``fast``)
    relative : relative tolerance of a step

    Raises
    ------
    Unsolvable
        no step is small enough, or a state is not finite
    InputError
        "cvodes" without CasADi, or with a record
    """
    counted = [0]
    tolerance = RELATIVE[method] if relative is None else relative
    advance = METHODS[method](compiled, tolerance, counted)
    run = _Run(compiled, advance, duration)
    count = max(round(duration / sample_time), 1)
    looks = math.ceil(sample_time / LOOK) if compiled.system.switches else 1
    grid = np.linspace(0.0, duration, looks * count + 1)
    told = np.arange(looks * count + 1) % looks == 0
    stops = [0.0]
    for moment in sorted(compiled.instants):
        if stops[-1] + APART < moment < duration - APART:
            stops.append(moment)
    near = 1e-6 * sample_time / looks  # a sample close to an instant moves to it
    t, y = 0.0, compiled.initial.copy()
    m = _flags(compiled, t, y, ())
    for stop in (*stops[1:], duration):
        inside = (grid > t + near) & (grid < stop - near)
        times = np.concatenate(([t], grid[inside], [stop]))
        y, m = _segment(run, times, np.concatenate(([True], told[inside], [True])), y, m)
        t = stop
        m = _flags(compiled, t, y, m)
    return Trajectory(
        np.concatenate(run.time),
        np.concatenate(run.states).T.copy(),
        np.concatenate(run.flags, axis=1),
        tuple(run.events),
        counted[0],
        run.restarts,
    )


def _flags(compiled: Compiled, t: float, y: Array, before: tuple[bool, ...]) -> tuple[bool, ...]:
    """Flags at an instant; switches keep their state."""
    instants = tuple(t + APART >= one for one in compiled.instants)
    if before:
        return instants + before[len(instants) :]
    guards = _each(compiled, compiled.guards, np.array([t]), y[None], ())
    return instants + tuple(guards[:, 0] > 0)


def _margins(run: _Run, t: Array, states: Array, m: tuple[bool, ...]) -> tuple[Array, Array]:
    """Guard of every switch and its rate, (switches, samples)."""
    signs = np.where(m[len(run.compiled.instants) :], 1.0, -1.0)[:, None]
    margin = _each(run.compiled, run.compiled.guards, t, states, m) * signs
    return margin, _each(run.compiled, run.compiled.guard_rates, t, states, m) * signs


def _each(
    compiled: Compiled,
    function: Callable[[Array, Array, tuple[Array, ...]], list[Array]],
    t: Array,
    states: Array,
    m: tuple[bool, ...],
) -> Array:
    """A function of every switch at samples, (switches, samples)."""
    count = len(compiled.system.switches)
    if not count:
        return np.empty((0, len(t)))
    flags = m or (False,) * (len(compiled.instants) + count)
    return np.array([np.broadcast_to(one, t.shape) for one in function(t, states.T, flags)])


def _segment(
    run: _Run, times: Array, told: Array, y: Array, m: tuple[bool, ...]
) -> tuple[Array, tuple[bool, ...]]:
    """Integrate over some times without an input jump; only some samples are stored."""
    first, last = len(run.compiled.instants), len(times) - 1
    begin, start, own = 0, float(times[0]), True
    while begin < last:
        end = min(begin + CHUNK, last)
        asked = np.concatenate(([start], times[begin + 1 : end + 1]))
        wanted = np.concatenate(([own], told[begin + 1 : end + 1]))
        asked, found, turn = _ahead(run, asked, y, m)
        run.restarts += 1
        tell("simulating", start / run.duration)
        if turn is None:
            wanted[-1] &= end == last  # the next section has its first sample
            run.keep(asked[wanted], found[wanted], m)
            y, start, own, begin = found[-1], float(times[end]), bool(told[end]), end
            continue
        k, at, there, which = turn
        before = np.flatnonzero(wanted[: k + 1] & (asked[: k + 1] < at))
        run.keep(np.append(asked[before], at), np.vstack((found[before], there)), m)
        m = tuple(flag ^ (i == first + which) for i, flag in enumerate(m))
        name = run.compiled.system.switches[which].name
        run.events.append(Event(name, at, bool(m[first + which])))
        if len(run.events) > MOST_TURNS:
            remedy = "increase the damping of the part that switches"
            raise Stuck(at, there, f"{name} switches without end", remedy)
        y, start, own = there, at, True
        begin += k + (at >= times[begin + k + 1])
    return y, m


Turn = tuple[int, float, Array, int]
"""Sample before it, time, states and number of a switch that changes."""


def _ahead(
    run: _Run, times: Array, y: Array, m: tuple[bool, ...]
) -> tuple[Array, Array, Turn | None]:
    """States at some times and the first switch, beyond which the equations may fail."""
    try:
        found = run.advance(times, y, m, FEW)
        return times, found, _first_turn(run, times, found, m)
    except Stuck as stuck:
        good, bad = float(times[0]), min(stuck.time, float(times[-1]))
    near = good + 0.99 * (bad - good)
    for _ in range(TRIES if run.compiled.system.switches else 0):
        short = np.append(times[times < near], near)
        try:
            found = run.advance(short, y, m, FEW)
        except Stuck:
            bad = near
        else:
            turn = _first_turn(run, short, found, m)
            if turn is not None:
                return short, found, turn
            good = near
        near = 0.5 * (good + bad)
    found = run.advance(times, y, m, MOST)
    return times, found, _first_turn(run, times, found, m)


def _first_turn(run: _Run, times: Array, found: Array, m: tuple[bool, ...]) -> Turn | None:
    """The first switch between samples."""
    if not run.compiled.system.switches:
        return None
    suspect = _suspects(times, *_margins(run, times, found, m))
    for k in np.flatnonzero(suspect.any(axis=0)):
        turns = []
        for which in np.flatnonzero(suspect[:, k]):
            turn = _turn(run, times[k : k + 2], found[k], m, int(which))
            if turn is not None:
                turns.append((int(k), *turn, int(which)))
        if turns:
            return min(turns, key=lambda one: one[1])
    return None


def _suspects(times: Array, margin: Array, slope: Array) -> Array:
    """Intervals with a guard crossing at the end, or on the cubic through both ends."""
    step = np.diff(times)
    (a, b), (c, d) = (
        (margin[:, :-1], margin[:, 1:]), (slope[:, :-1] * step, slope[:, 1:] * step),
    )  # fmt: skip
    gone = b <= 0
    valley = ~gone & (c < 0) & (d > 0)
    if valley.any():
        for s in np.linspace(0.1, 0.9, 9):
            here = (1 + 2 * s) * (1 - s) ** 2 * a + s * (1 - s) ** 2 * c
            here += s * s * (3 - 2 * s) * b + s * s * (s - 1) * d
            gone = gone | (valley & (here <= 0))
    return gone


def _turn(
    run: _Run, span: Array, y: Array, m: tuple[bool, ...], which: int, level: int = 0
) -> tuple[float, Array] | None:
    """Time and states at which a switch changes within an interval, or None."""
    from scipy.optimize import brentq

    times = np.linspace(span[0], span[1], PARTS + 1)
    states = run.advance(times, y, m, MOST)
    margin, slope = (one[which : which + 1] for one in _margins(run, times, states, m))
    for k in np.flatnonzero(_suspects(times, margin, slope)[0]):
        low, high, here = float(times[k]), float(times[k + 1]), states[k]
        if margin[0, k] > 0 >= margin[0, k + 1]:

            def left(t: float, low: float = low, here: Array = here) -> float:
                y = _state_at(run, low, t, here, m)
                return float(_margins(run, np.array([t]), y[None], m)[0][which, 0])

            at = high
            if left(high) <= 0:
                at = float(brentq(left, low, high, xtol=_LOCATED * max(high, 1.0), rtol=1e-14))
            return at, _state_at(run, low, at, here, m)
        if margin[0, k] <= 0 and (slope[0, k] <= 0 or level == LEVELS):
            return low, here
        if level < LEVELS:
            turn = _turn(run, times[k : k + 2], here, m, which, level + 1)
            if turn is not None:
                return turn
    return None


def _state_at(run: _Run, start: float, t: float, y: Array, m: tuple[bool, ...]) -> Array:
    return y if t <= start else run.advance(np.array([start, t]), y, m, MOST)[-1]


def _cvodes(compiled: Compiled, relative: float, counted: list[int]) -> Advance:
    from .fast import cvodes

    return cvodes(compiled, relative, counted, lsoda(compiled, RELATIVE["lsoda"], counted))


METHODS: Final[dict[Method, Callable[[Compiled, float, list[int]], Advance]]] = {
    "lsoda": lsoda, "radau": radau, "cvodes": _cvodes,
}  # fmt: skip
LAST = 0.1
"""Final share of a record that counts as steady (a choice)."""


def sampled(*, time: Array, fewest: int = 2, **channels: Array) -> tuple[np.ndarray, ...]:
    """Time and channels as arrays of floats, in the order given.

    Parameters
    ----------
    time : (n,) [s], never decreasing: a jump has two samples at one time
    fewest : minimum number of samples
    channels : (n,) each

    Returns
    -------
    time and channels

    Raises
    ------
    InputError : channels of different length, a sample that is not a number, too few samples, or
        decreasing time
    """
    names = ("time", *channels)
    arrays = tuple(np.asarray(values, dtype=float) for values in (time, *channels.values()))
    shape = arrays[0].shape
    for name, values in zip(names, arrays, strict=True):
        if values.shape != shape or values.ndim != 1:
            message = f"{name} has shape {values.shape}, but time {shape}"
            raise InputError(Diagnostic(message, "give one number per sample in every channel"))
        broken = np.flatnonzero(~np.isfinite(values))
        if broken.size:
            message = f"{name} of sample {broken[0]} is {values[broken[0]]}"
            raise InputError(Diagnostic(message, "remove the sample"))
    if len(arrays[0]) < fewest:
        message = f"{len(arrays[0])} samples"
        raise InputError(Diagnostic(message, f"give {fewest} or more"))
    falls = np.flatnonzero(np.diff(arrays[0]) < 0)
    if falls.size:
        message = f"time decreases after sample {falls[0]}"
        raise InputError(Diagnostic(message, "sort the samples by time"))
    if arrays[0][-1] == arrays[0][0]:
        raise InputError(Diagnostic("time does not advance", "give samples over a longer time"))
    return arrays


def last_mean(time: np.ndarray, values: np.ndarray) -> float:
    """Mean over the last tenth of the time, with linear interpolation."""
    start = time[-1] - LAST * (time[-1] - time[0])
    inside = time > start
    t = np.concatenate([[start], time[inside]])
    v = np.concatenate([[np.interp(start, time, values)], values[inside]])
    return float(np.trapezoid(v, t) / (t[-1] - t[0]))
