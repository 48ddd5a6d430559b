"""Integrators of a smooth section: states at its samples, or how far they got.

LSODA switches between stiff and non-stiff steps and uses the exact Jacobian. Radau gives the second
opinion, CVODES (`fast`) is the faster one.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable
from typing import Any, Final, Literal

import numpy as np

from ..base.errors import Diagnostic, Unsolvable
from ..base.numeric import Array
from .system import Compiled

Method = Literal["lsoda", "radau", "cvodes"]
RELATIVE: Final = {"lsoda": 1e-6, "radau": 1e-8, "cvodes": 1e-7}
"""Relative tolerance of a step; the second opinion uses the tighter one."""
CHUNK = 200
"""Samples between checks of the switches (a choice: work beyond a switch is lost)."""
MOST = 100_000
"""Maximum steps between two samples."""

Advance = Callable[[Array, Array, tuple[bool, ...], int], Array]
"""States (times, states) at the given times, with a maximum number of steps between two."""


class Stuck(Unsolvable):
    """An integration that failed at a time, near a state."""

    def __init__(self, time: float, state: Array, message: str, remedy: str) -> None:
        super().__init__(Diagnostic(f"at {time:.6g} s: {message}", remedy))
        self.time, self.state = time, np.array(state)


def _checked(times: Array, found: Array) -> Array:
    """The states, if all are finite."""
    bad = ~np.isfinite(found).all(axis=1)
    if bad.any():
        first = int(np.argmax(bad))
        message = "the equations have no solution"
        raise Stuck(float(times[first]), found[max(first - 1, 0)], message, REMEDY)
    return found


REMEDY = (
    "a gain, a volume or a leakage may be implausible; end the run earlier and check its signals"
)


def _why(error: Exception) -> str:
    return f"the equations cannot be evaluated ({error})"


def _longest(compiled: Compiled, times: Array) -> float:
    """Longest step that resolves a record; 0 without a limit."""
    bends = compiled.bends
    first, last = np.searchsorted(bends, times[0]), np.searchsorted(bends, times[-1], "right")
    if first == last:
        return 0.0
    shortest = float(np.min(np.diff(bends[max(first - 1, 0) : last + 1]), initial=np.inf))
    return max(shortest, float(times[-1] - times[0]) / MOST)


def lsoda(compiled: Compiled, relative: float, counted: list[int]) -> Advance:
    """Integration by LSODA; Radau takes over sections whose stiffness LSODA misses."""
    from scipy.integrate import ODEintWarning, odeint

    reached: list[Any] = [0.0, compiled.initial]
    stiff = radau(compiled, relative, counted)

    def rates(t: float, y: Array, m: tuple[bool, ...]) -> list[float]:
        reached[:] = t, y
        return compiled.rates(t, y, m)

    def advance(times: Array, y: Array, m: tuple[bool, ...], most: int) -> Array:
        reached[:] = float(times[0]), y
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", ODEintWarning)
            try:
                found, report = odeint(
                    rates, y, times, args=(m,), Dfun=compiled.slopes, tfirst=True,
                    rtol=relative, atol=compiled.tolerances, mxstep=most, full_output=True,
                    hmax=_longest(compiled, times), tcrit=times[-1:],
                )  # fmt: skip
            except (ArithmeticError, ValueError) as error:
                raise Stuck(reached[0], reached[1], _why(error), REMEDY) from None
        if report["message"] != "Integration successful.":
            if most < MOST:
                raise Stuck(reached[0], reached[1], "no step is small enough", REMEDY)
            return stiff(times, y, m, most)  # near rest LSODA may miss their stiffness
        counted[0] += int(report["nfe"][-1])
        return _checked(times, found)

    return advance


def radau(compiled: Compiled, relative: float, counted: list[int]) -> Advance:
    """Integration by Radau, implicit of order five."""
    from scipy.integrate import solve_ivp

    reached: list[Any] = [0.0, compiled.initial]

    def advance(times: Array, y: Array, m: tuple[bool, ...], most: int) -> Array:
        def rates(t: float, y: Array) -> list[float]:
            reached[:] = t, y
            return compiled.rates(t, y, m)

        try:
            with np.errstate(all="ignore"):
                found = solve_ivp(
                    rates, (times[0], times[-1]), y, method="Radau", t_eval=times,
                    rtol=relative, atol=0.01 * compiled.tolerances,
                    jac=lambda t, y: compiled.slopes(t, y, m),
                    max_step=_longest(compiled, times) or np.inf,
                )  # fmt: skip
        except (ArithmeticError, ValueError) as error:
            raise Stuck(reached[0], reached[1], _why(error), REMEDY) from None
        counted[0] += int(found.nfev)
        if not found.success:
            raise Stuck(reached[0], reached[1], "no step is small enough", REMEDY)
        return _checked(times, found.y.T)

    return advance
