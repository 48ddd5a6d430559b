"""Integration in time: restarted where an input jumps or a switch turns, never across it.

LSODA changes between stiff and non-stiff steps by itself and has the exact Jacobian; Radau is the
second opinion.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Final, Literal

import numpy as np

from ..errors import Diagnostic, Unsolvable
from ..numeric import Array
from .system import Compiled

Method = Literal["lsoda", "radau"]
RELATIVE: Final = {"lsoda": 1e-6, "radau": 1e-8}
"""Relative tolerance of a step; the second opinion is the sharper one."""
CHUNK = 400
"""Samples between two looks at the switches."""
MOST_TURNS = 20_000
"""Turns of switches before a run counts as chattering (a choice)."""
_LOCATED = 1e-12


@dataclass(frozen=True, slots=True)
class Event:
    """A switch that turned."""

    name: str
    time: float
    on: bool


@dataclass(slots=True)
class Trajectory:
    """States at samples; an instant or event stands twice, with the flags before and after it."""

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
    advance: Callable[[Array, Array, tuple[bool, ...]], Array]
    """States at times from the first on: (times, states)."""
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
    """States over time.

    Parameters
    ----------
    compiled : the equations
    duration : simulated time [s]
    sample_time : of the result [s]; steps inside are the method's own
    method : "lsoda" or "radau"
    relative : relative tolerance of a step

    Raises
    ------
    Unsolvable
        where no step is small enough, or a state is no longer a number
    """
    counted = [0]
    tolerance = RELATIVE[method] if relative is None else relative
    advance = (_lsoda if method == "lsoda" else _radau)(compiled, tolerance, counted)
    run = _Run(compiled, advance)
    count = max(round(duration / sample_time), 1)
    grid = np.linspace(0.0, duration, count + 1)
    stops = sorted({t for t in compiled.instants if 0 < t < duration} | {duration})
    near = 1e-6 * sample_time  # a sample beside an instant is that instant
    t, y = 0.0, compiled.initial.copy()
    m = _flags(compiled, t, y, ())
    for stop in stops:
        inside = grid[(grid > t + near) & (grid < stop - near)]
        y, m = _segment(run, np.concatenate(([t], inside, [stop])), y, m)
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
    """Flags at an instant; switches keep what they had."""
    instants = tuple(t >= one for one in compiled.instants)
    if before:
        return instants + before[len(instants) :]
    return instants + tuple(_guards(compiled, np.array([t]), y[None])[:, 0] > 0)


def _guards(compiled: Compiled, t: Array, states: Array) -> Array:
    """Guards at samples, (switches, samples)."""
    count = len(compiled.system.switches)
    if not count:
        return np.empty((0, len(t)))
    nothing = (False,) * (len(compiled.instants) + count)
    values = compiled.guards(t, states.T, nothing)
    return np.array([np.broadcast_to(value, t.shape) for value in values])


def _segment(
    run: _Run, times: Array, y: Array, m: tuple[bool, ...]
) -> tuple[Array, tuple[bool, ...]]:
    """From the first to the last of some times, no input jumping between."""
    first = len(run.compiled.instants)
    begin, chunk = 0, CHUNK
    start = times[0]
    while begin < len(times) - 1:
        end = min(begin + chunk, len(times) - 1)
        asked = np.concatenate(([start], times[begin + 1 : end + 1]))
        run.restarts += 1
        try:
            found = run.advance(asked, y, m)
        except Unsolvable:
            if chunk == 1:
                raise
            chunk = max(chunk // 8, 1)
            continue
        chunk = min(2 * chunk, CHUNK)
        turned = (_guards(run.compiled, asked, found) > 0) != np.array(m[first:], bool)[:, None]
        turned[:, 0] = False
        hit = np.flatnonzero(turned.any(axis=0)) if turned.size else np.empty(0, int)
        if not hit.size:
            run.keep(asked, found, m)
            y, start, begin = found[-1], times[end], end
            continue
        k = int(hit[0])
        at, there, which = _locate(run, asked, found, k, m)
        run.keep(np.append(asked[:k], at), np.vstack((found[:k], there)), m)
        m = tuple(bool(flag) ^ (i == first + which) for i, flag in enumerate(m))
        name = run.compiled.system.switches[which].name
        run.events.append(Event(name, at, m[first + which]))
        if len(run.events) > MOST_TURNS:
            raise _failure(at, f"{name} turns without end", "raise the damping of what turns it")
        y, start = there, at
        begin += k - 1 if at < asked[k] else k
    return y, m


def _locate(
    run: _Run, times: Array, found: Array, k: int, m: tuple[bool, ...]
) -> tuple[float, Array, int]:
    """Time, states and number of the first switch that turns before sample k."""
    from scipy.optimize import brentq

    first = len(run.compiled.instants)
    low, high = float(times[k - 1]), float(times[k])
    signs = np.where(m[first:], 1.0, -1.0)
    before = _guards(run.compiled, times[k - 1 : k], found[k - 1 : k])[:, 0] * signs
    after = _guards(run.compiled, times[k : k + 1], found[k : k + 1])[:, 0] * signs
    best: tuple[float, int] | None = None
    for which in np.flatnonzero(after <= 0):
        if before[which] <= 0:  # turned at the start of this piece, and back: at once
            moment = low
        else:

            def margin(t: float, which: int = which) -> float:
                y = _state_at(run, low, t, found[k - 1], m)
                value = _guards(run.compiled, np.array([t]), y[None])[which, 0]
                return float(value * signs[which])

            moment = float(brentq(margin, low, high, xtol=_LOCATED * max(high, 1.0), rtol=1e-14))
        if best is None or moment < best[0]:
            best = moment, int(which)
    assert best is not None
    return best[0], _state_at(run, low, best[0], found[k - 1], m), best[1]


def _state_at(run: _Run, start: float, t: float, y: Array, m: tuple[bool, ...]) -> Array:
    return y if t <= start else run.advance(np.array([start, t]), y, m)[-1]


def _failure(time: float, message: str, remedy: str) -> Unsolvable:
    return Unsolvable(Diagnostic(f"at {time:.6g} s: {message}", remedy))


def _checked(times: Array, found: Array) -> Array:
    """The states, where all of them are numbers."""
    bad = ~np.isfinite(found).all(axis=1)
    if bad.any():
        at = float(times[int(np.argmax(bad))])
        raise _failure(at, "the equations have no solution", "look at the signals up to there")
    return found


def _lsoda(
    compiled: Compiled, relative: float, counted: list[int]
) -> Callable[[Array, Array, tuple[bool, ...]], Array]:
    from scipy.integrate import ODEintWarning, odeint

    def advance(times: Array, y: Array, m: tuple[bool, ...]) -> Array:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", ODEintWarning)
            try:
                found, report = odeint(
                    compiled.rates, y, times, args=(m,), Dfun=compiled.slopes, tfirst=True,
                    rtol=relative, atol=compiled.tolerances, mxstep=100_000, full_output=True,
                )  # fmt: skip
            except (ArithmeticError, ValueError) as error:
                raise _failure(float(times[0]), _why(error), _REMEDY) from None
        counted[0] += int(report["nfe"][-1])
        if report["message"] != "Integration successful.":
            raise _failure(_reached(report, times), "no step is small enough", _REMEDY)
        return _checked(times, found)

    return advance


_REMEDY = "look at the signals up to there: a gain, a volume or a leakage may be absurd"


def _why(error: Exception) -> str:
    return f"the equations cannot be evaluated ({error})"


def _reached(report: dict[str, Array], times: Array) -> float:
    known = report["tcur"]
    return float(np.max(known)) if np.size(known) else float(times[0])


def _radau(
    compiled: Compiled, relative: float, counted: list[int]
) -> Callable[[Array, Array, tuple[bool, ...]], Array]:
    from scipy.integrate import solve_ivp

    def advance(times: Array, y: Array, m: tuple[bool, ...]) -> Array:
        try:
            found = solve_ivp(
                lambda t, y: compiled.rates(t, y, m), (times[0], times[-1]), y, method="Radau",
                t_eval=times, rtol=relative, atol=0.01 * compiled.tolerances,
                jac=lambda t, y: np.array(compiled.slopes(t, y, m)),
            )  # fmt: skip
        except (ArithmeticError, ValueError) as error:
            raise _failure(float(times[0]), _why(error), _REMEDY) from None
        counted[0] += int(found.nfev)
        if not found.success:
            at = float(found.t[-1]) if np.size(found.t) else float(times[0])
            raise _failure(at, "no step is small enough", _REMEDY)
        return _checked(times, found.y.T)

    return advance
