"""Integration in time, which restarts where an input jumps or a switch changes state.

Each call of an integrator covers a section without jumps. It returns the states at the sample times
or raises `Stuck`. LSODA switches between stiff and non-stiff steps and uses the exact Jacobian.
Radau serves as an independent check.
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable
from dataclasses import field
from functools import cache
from typing import Final, Literal

import numpy as np

from ..base.dataclass import dataclass
from ..base.errors import Diagnostic, InputError, Unsolvable
from ..base.numeric import Array
from ..base.progress import tell
from ..base.symbolic.equations import PointFunctions
from .system import Compiled

Method = Literal["lsoda", "radau"]


RELATIVE: Final = {"lsoda": 1e-6, "radau": 1e-8}
"""Relative tolerance of a step; tighter for Radau, which checks LSODA."""


CHUNK = 200
"""Number of samples after which the integration checks whether a switch of the model has changed
(our choice: few, because the samples after a change are discarded)."""


LONGER = 4
"""Factor on this number after every check without a change (our choice: a method that restarts
takes short steps at first, and LSODA may miss that the equations are stiff)."""


MOST = 100_000
"""Maximum number of integration steps between two samples."""


Advance = Callable[[Array, Array, tuple[bool, ...], int], Array]
"""Function that returns the states at given times, one row per time, for given initial states and
flags. Its last argument is the maximum number of steps between two times."""


class Stuck(Unsolvable):
    """Error of a failed integration; contains the time of the failure and the states then."""

    def __init__(self, time: float, state: Array, message: str, remedy: str) -> None:
        super().__init__(Diagnostic(f"at {time:.6g} s: {message}", remedy))
        self.time, self.state = time, np.array(state)


def _checked(times: Array, states: Array) -> Array:
    """Return the states if all are finite, else raise an error."""
    bad = ~np.isfinite(states).all(axis=1)
    if bad.any():
        first = int(np.argmax(bad))
        message = "the equations have no solution"
        raise Stuck(float(times[first]), states[max(first - 1, 0)], message, REMEDY)
    return states


REMEDY = (
    "a gain, a volume or a leakage may be implausible; end the run earlier and check its signals"
)


def _reason(error: Exception) -> str:
    return f"the equations cannot be evaluated ({error})"


def _stuck(rates: PointFunctions, message: str) -> Stuck:
    """Error of an integration that fails at the point where the rates were computed last."""
    time, *state = rates.latest().tolist()
    return Stuck(time, np.array(state), message, REMEDY)


def _longest(compiled: Compiled, times: Array) -> float:
    """Longest step that does not skip samples of the input records; 0 for no limit."""
    bends = compiled.bends
    first, last = np.searchsorted(bends, times[0]), np.searchsorted(bends, times[-1], "right")
    if first == last:
        return 0.0
    shortest = float(np.min(np.diff(bends[max(first - 1, 0) : last + 1]), initial=np.inf))
    return max(shortest, float(times[-1] - times[0]) / MOST)


def lsoda(compiled: Compiled, relative: float, evaluations: list[int]) -> Advance:
    """Integration by LSODA; Radau takes over sections whose stiffness LSODA misses."""
    from scipy.integrate import ODEintWarning, odeint

    stiff = radau(compiled, relative, evaluations)
    at_point = cache(compiled.rates.at_point)

    def advance(times: Array, y: Array, m: tuple[bool, ...], max_steps: int) -> Array:
        rates = at_point(m)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", ODEintWarning)
            try:
                states, report = odeint(
                    rates.values, y, times, Dfun=rates.slopes, tfirst=True,
                    rtol=relative, atol=compiled.tolerances, mxstep=max_steps, full_output=True,
                    hmax=_longest(compiled, times), tcrit=times[-1:],
                )  # fmt: skip
            except (ArithmeticError, ValueError) as error:
                raise _stuck(rates, _reason(error)) from None
        if report["message"] != "Integration successful.":
            if max_steps < MOST:
                raise _stuck(rates, "no time step is small enough")
            # near rest LSODA may miss that the equations are stiff
            return stiff(times, y, m, max_steps)
        evaluations[0] += int(report["nfe"][-1])
        return _checked(times, states)

    return advance


def radau(compiled: Compiled, relative: float, evaluations: list[int]) -> Advance:
    """Integration by Radau, an implicit method of order five."""
    from scipy.integrate import solve_ivp

    at_point = cache(compiled.rates.at_point)

    def advance(times: Array, y: Array, m: tuple[bool, ...], max_steps: int) -> Array:
        rates = at_point(m)
        try:
            with np.errstate(all="ignore"):
                solution = solve_ivp(
                    lambda t, y: np.array(rates.values(t, y)), (times[0], times[-1]), y,
                    method="Radau", t_eval=times, rtol=relative, atol=0.01 * compiled.tolerances,
                    jac=lambda t, y: rates.slopes(t, y).copy(),
                    max_step=_longest(compiled, times) or np.inf,
                )  # fmt: skip
        except (ArithmeticError, ValueError) as error:
            raise _stuck(rates, _reason(error)) from None
        evaluations[0] += int(solution.nfev)
        if not solution.success:
            raise _stuck(rates, "no time step is small enough")
        return _checked(times, solution.y.T)

    return advance


LOOK = 2e-3
"""Longest time between two checks of a switch [s] (our choice: half the period of a fast oil
oscillation)."""
MOST_CHANGES = 20_000
"""Number of changes of a switch above which it counts as chattering (our choice)."""
APART = 1e-9
"""Largest difference between times that count as equal [s] (our choice)."""
FEW = 2_000
"""Maximum number of integration steps between two samples in a first attempt. The attempt may run
past a switch change, where the equations are no longer valid and the steps become tiny."""
TRIES = 12
"""Number of ever shorter sections in which the first switch change is searched for, if the
integration over the full section fails."""
PARTS, LEVELS = 16, 5
"""Number of parts into which an interval is divided if a switch may change in it, and how many
times such a part may be divided again."""
_LOCATED = 1e-12


@dataclass(frozen=True, slots=True)
class Event:
    """A change of a switch."""

    name: str
    time: float
    on: bool


@dataclass(slots=True)
class Trajectory:
    """States over time. At a jump there are two samples, with the flags before and after it."""

    time: Array
    states: Array
    """One row per state, one column per sample."""
    flags: Array
    """One row per flag, one column per sample."""
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
    sample_time : interval between the samples of the result [s]; the method chooses its own
        internal steps
    method : "lsoda" or "radau"
    relative : relative tolerance of a step; None for the usual tolerance of the method

    Raises
    ------
    Unsolvable
        the step became too small, or a state is not finite
    """
    evaluations = [0]
    tolerance = RELATIVE[method] if relative is None else relative
    advance = METHODS[method](compiled, tolerance, evaluations)
    run = _Run(compiled, advance, duration)
    count = max(round(duration / sample_time), 1)
    checks = math.ceil(sample_time / LOOK) if compiled.system.switches else 1
    grid = np.linspace(0.0, duration, checks * count + 1)
    is_stored = np.arange(checks * count + 1) % checks == 0
    stops = [0.0]
    for instant in sorted(compiled.instants):
        if stops[-1] + APART < instant < duration - APART:
            stops.append(instant)
    near = 1e-6 * sample_time / checks  # a sample this close to an input jump is moved to the jump
    t, y = 0.0, compiled.initial.copy()
    m = _flags(compiled, t, y, ())
    for stop in (*stops[1:], duration):
        inside = (grid > t + near) & (grid < stop - near)
        times = np.concatenate(([t], grid[inside], [stop]))
        y, m = _segment(run, times, np.concatenate(([True], is_stored[inside], [True])), y, m)
        t = stop
        m = _flags(compiled, t, y, m)
    return Trajectory(
        np.concatenate(run.time),
        np.concatenate(run.states).T.copy(),
        np.concatenate(run.flags, axis=1),
        tuple(run.events),
        evaluations[0],
        run.restarts,
    )


def _flags(compiled: Compiled, t: float, y: Array, before: tuple[bool, ...]) -> tuple[bool, ...]:
    """On/off flags of the equations after a restart of the integration.

    The flag of an instant (a given time) is true from that time on. The flag of a switch keeps its
    value; only at the very start, it follows from the sign of the switch's guard expression.
    """
    instants = tuple(t + APART >= instant for instant in compiled.instants)
    if before:
        return instants + before[len(instants) :]
    off = (False,) * len(compiled.system.switches)
    at_start = compiled.switches.at_samples(np.array([t]), y[:, None], instants + off)
    return instants + tuple((at_start[: len(off), 0] > 0).tolist())


def _margins(run: _Run, t: Array, states: Array, m: tuple[bool, ...]) -> tuple[Array, Array]:
    """Guard expression of every switch, and its time derivative; arrays (switches, samples).

    If a switch is off, both are negated, so the guard is positive until the switch changes.
    """
    signs = np.where(m[len(run.compiled.instants) :], 1.0, -1.0)[:, None]
    margin, slope = np.split(run.compiled.switches.at_samples(t, states.T, m), 2)
    return margin * signs, slope * signs


def _segment(
    run: _Run, times: Array, is_stored: Array, y: Array, m: tuple[bool, ...]
) -> tuple[Array, tuple[bool, ...]]:
    """Integrate between two jumps of the inputs; store only the samples marked in `is_stored`."""
    first, last = len(run.compiled.instants), len(times) - 1
    begin, start, store_first, length = 0, float(times[0]), True, CHUNK
    while begin < last:
        end = min(begin + length, last)
        section = np.concatenate(([start], times[begin + 1 : end + 1]))
        stored = np.concatenate(([store_first], is_stored[begin + 1 : end + 1]))
        section, sampled_states, change = _section_to_change(run, section, y, m)
        run.restarts += 1
        tell("simulating", start / run.duration)
        if change is None:
            # if it ends at a switch change, the next section stores that sample
            stored[-1] &= end == last
            run.keep(section[stored], sampled_states[stored], m)
            y, start, store_first, begin = (
                sampled_states[-1],
                float(times[end]),
                bool(is_stored[end]),
                end,
            )
            length *= LONGER
            continue
        k, time, state, switch = change
        before = np.flatnonzero(stored[: k + 1] & (section[: k + 1] < time))
        run.keep(np.append(section[before], time), np.vstack((sampled_states[before], state)), m)
        m = tuple(flag ^ (i == first + switch) for i, flag in enumerate(m))
        name = run.compiled.system.switches[switch].name
        run.events.append(Event(name, time, bool(m[first + switch])))
        if len(run.events) > MOST_CHANGES:
            remedy = "increase the damping of the component that switches"
            raise Stuck(time, state, f"{name} switches back and forth endlessly", remedy)
        y, start, store_first, length = state, time, True, CHUNK
        begin += k + (time >= times[begin + k + 1])
    return y, m


SwitchChange = tuple[int, float, Array, int]
"""A switch change: index of the sample before it, time and states at the change, and index of the
switch."""


def _section_to_change(
    run: _Run, times: Array, y: Array, m: tuple[bool, ...]
) -> tuple[Array, Array, SwitchChange | None]:
    """Integrate past the first switch change; if that fails, at least up to this change."""
    try:
        states = run.advance(times, y, m, FEW)
        return times, states, _first_change(run, times, states, m)
    except Stuck as stuck:
        good, bad = float(times[0]), min(stuck.time, float(times[-1]))
    near = good + 0.99 * (bad - good)
    for _ in range(TRIES if run.compiled.system.switches else 0):
        short = np.append(times[times < near], near)
        try:
            states = run.advance(short, y, m, FEW)
        except Stuck:
            bad = near
        else:
            change = _first_change(run, short, states, m)
            if change is not None:
                return short, states, change
            good = near
        near = 0.5 * (good + bad)
    states = run.advance(times, y, m, MOST)
    return times, states, _first_change(run, times, states, m)


def _first_change(
    run: _Run, times: Array, states: Array, m: tuple[bool, ...]
) -> SwitchChange | None:
    """The first change of a switch between samples."""
    if not run.compiled.system.switches:
        return None
    suspect = _suspects(times, *_margins(run, times, states, m))
    for k in np.flatnonzero(suspect.any(axis=0)):
        changes = []
        for switch in np.flatnonzero(suspect[:, k]):
            change = _change_within(run, times[k : k + 2], states[k], m, int(switch))
            if change is not None:
                changes.append((int(k), *change, int(switch)))
        if changes:
            return min(changes, key=lambda candidate: candidate[1])
    return None


def _suspects(times: Array, margin: Array, slope: Array) -> Array:
    """Whether each guard changes sign in each interval, judged by a cubic with its end slopes."""
    step = np.diff(times)
    (a, b), (c, d) = (
        (margin[:, :-1], margin[:, 1:]), (slope[:, :-1] * step, slope[:, 1:] * step),
    )  # fmt: skip
    crosses = b <= 0
    valley = ~crosses & (c < 0) & (d > 0)
    if valley.any():
        a, b, c, d = (end[valley] for end in (a, b, c, d))
        below = np.zeros(a.shape, dtype=bool)
        for s in np.linspace(0.1, 0.9, 9):
            guard = (1 + 2 * s) * (1 - s) ** 2 * a + s * (1 - s) ** 2 * c
            guard += s * s * (3 - 2 * s) * b + s * s * (s - 1) * d
            below |= guard <= 0
        crosses[valley] = below
    return crosses


def _change_within(
    run: _Run, span: Array, y: Array, m: tuple[bool, ...], switch: int, level: int = 0
) -> tuple[float, Array] | None:
    """Time and states at which a switch changes within an interval, or None if it does not."""
    from scipy.optimize import brentq

    times = np.linspace(span[0], span[1], PARTS + 1)
    states = run.advance(times, y, m, MOST)
    margin, slope = (margin[switch : switch + 1] for margin in _margins(run, times, states, m))
    for k in np.flatnonzero(_suspects(times, margin, slope)[0]):
        low, high, start_states = float(times[k]), float(times[k + 1]), states[k]
        if margin[0, k] > 0 >= margin[0, k + 1]:

            def left(moment: float, low: float = low, start_states: Array = start_states) -> float:
                y = _state_at(run, low, moment, start_states, m)
                return float(_margins(run, np.array([moment]), y[None], m)[0][switch, 0])

            at = high
            if left(high) <= 0:
                at = float(brentq(left, low, high, xtol=_LOCATED * max(high, 1.0), rtol=1e-14))
            return at, _state_at(run, low, at, start_states, m)
        if margin[0, k] <= 0 and (slope[0, k] <= 0 or level == LEVELS):
            return low, start_states
        if level < LEVELS:
            change = _change_within(run, times[k : k + 2], start_states, m, switch, level + 1)
            if change is not None:
                return change
    return None


def _state_at(run: _Run, start: float, t: float, y: Array, m: tuple[bool, ...]) -> Array:
    return y if t <= start else run.advance(np.array([start, t]), y, m, MOST)[-1]


METHODS: Final[dict[Method, Callable[[Compiled, float, list[int]], Advance]]] = {
    "lsoda": lsoda, "radau": radau,
}  # fmt: skip
LAST = 0.1
"""Share of a record, at its end, in which motion counts as steady (our choice)."""


def sampled(*, time: Array, fewest: int = 2, **channels: Array) -> tuple[np.ndarray, ...]:
    """Time and channels as arrays of floats, in the given order.

    Parameters
    ----------
    time : (n,) [s], never decreasing; a jump has two samples at the same time
    fewest : smallest permitted number of samples
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
            message = f"{name} has shape {values.shape}, but time has shape {shape}"
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
