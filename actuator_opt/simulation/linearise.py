"""The linear loop of a circuit: its equations about a point, open at the valve's signal."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from math import inf, pi

import numpy as np

from ..numeric import Array
from ..symbolic import function, jacobian
from .parts.circuit import Circuit

TOUCH = 1e-9
"""Position of the spool beside its centre [V]: which pair of edges opens."""
PLACES = ("position", "shaft angle")
"""States that change while an actuator runs steadily."""
CREEP = 1e-3
"""Rate of a growing pole that does not swing, over the slowest swing, that counts as creep (a
choice: beside a point of rest the load drifts a little)."""
ROUNDING = 1e-6
"""Real part over the size of a swinging pole that is rounding."""
POINTS = 2000
"""Frequencies between two decades below the slowest and one above the fastest pole."""


@dataclass(frozen=True, slots=True)
class OpenLoop:
    """Measured value over signal, L(s) = sum of r_i/(s - lambda_i)."""

    poles: Array
    residues: Array

    def at(self, omega: Array) -> Array:
        """L(i omega)."""
        s = 1j * np.asarray(omega, dtype=float)[..., None]
        return np.sum(self.residues / (s - self.poles), axis=-1)

    @property
    def frequencies(self) -> Array:
        """Angular frequencies that show every resonance [rad/s]."""
        size = np.abs(self.poles)
        size = size[size > 1e-3]
        grid = np.geomspace(size.min() / 100, size.max() * 10, POINTS)
        near = size[:, None] * (1 + np.array([-0.02, -0.005, -1e-3, 0.0, 1e-3, 0.005, 0.02]))
        return np.unique(np.concatenate((grid, near.ravel())))

    @property
    def swings(self) -> bool:
        """Whether a pole grows, apart from creep that any hold suppresses."""
        return _grow(self.poles)

    @property
    def steady_rate(self) -> float:
        """Steady rate of the measured value per signal: the residue of the integrator.

        That is the slowest pole; beside a point of rest it is not quite at zero.
        """
        return float(np.real(self.residues[np.argmin(np.abs(self.poles))]))


@dataclass(frozen=True, slots=True)
class Linear:
    """A circuit's linearisation, to be taken at any state."""

    circuit: Circuit
    names: tuple[str, ...]
    initial: Array
    scale: Array
    slopes: Callable[..., list[float]]
    rates: Callable[..., list[float]]
    flags: tuple[bool, ...]

    @classmethod
    def of(cls, circuit: Circuit) -> Linear:
        """Of a circuit assembled with ``linear=True``; its integrals are left out."""
        system = circuit.system
        states = [one for one in system.states if not one.integral]
        symbols = [one.symbol for one in states]
        u = system.graph.variable("u")
        rates = [one.rate for one in states]
        rows = jacobian([*rates, circuit.measured], [*symbols, u])
        flags = [one.flag for one in system.instants] + [one.flag for one in system.switches]
        unpack = {f"{', '.join(str(s.args[0]) for s in symbols)},": "y"}
        if flags:
            unpack[f"{', '.join(flags)},"] = "m"
        return cls(
            circuit=circuit,
            names=tuple(one.name for one in states),
            initial=np.array([one.initial for one in states]),
            scale=np.array([one.tolerance for one in states]),
            slopes=function("slopes", "t, y, u, m", unpack, [x for row in rows for x in row]),
            rates=function("rates", "t, y, u, m", unpack, rates),
            flags=(False,) * len(flags),
        )

    def loop(self, state: Array, signal: float, spool: float | None = None) -> OpenLoop:
        """The open loop about a state and a signal; flows follow the spool as where it is told."""
        table = self._table(state, signal)
        if spool is not None:
            moved, column = state.copy(), self.names.index("spool")
            moved[column] = spool
            table[:, column] = self._table(moved, signal)[:, column]
        size, d = len(state), self.scale
        a = table[:size, :size] * d / d[:, None]
        b, c = table[:size, size] / d, table[size, :size] * d
        poles, modes = np.linalg.eig(a)
        residues = (c @ modes) * np.linalg.solve(modes, b.astype(complex))
        return OpenLoop(poles, residues)

    def _table(self, state: Array, signal: float) -> Array:
        """Slopes of the rates and the measured value over the states and the signal."""
        size = len(state) + 1
        flat = self.slopes(0.0, state.tolist(), signal, self.flags)
        return np.array(flat).reshape(size, size)

    def about(self, **states: float) -> list[OpenLoop]:
        """Open loops where the valve holds the load, some states given: it opens to either side.

        Where nothing holds it, about the start.
        """
        still = {one: 0.0 for one in ("speed", "shaft_speed") if self._known(one)}
        found = self.steady(self.circuit.centre, **(still | states))
        if found is None:
            y = self._with(still | states)
            y[self.names.index("spool")] = self.circuit.centre
            found = y, self.circuit.centre
        return [self.loop(*found, spool=self.circuit.centre + side) for side in (TOUCH, -TOUCH)]

    def steady(self, guess: float, **states: float) -> tuple[Array, float] | None:
        """State and signal at which nothing but the place changes, some states given.

        Parameters
        ----------
        guess : signal near it [V]
        states : by name, SI

        Returns
        -------
        None where there is no such state
        """
        from scipy.optimize import root

        begin = self._with(states)
        given = {one.replace("_", " ") for one in states} | set(PLACES)
        free = [k for k, one in enumerate(self.names) if one not in given]
        kept = [k for k, one in enumerate(self.names) if one not in PLACES]
        scale = np.array([1e5 if abs(self.initial[k]) > 1e3 else 1.0 for k in free])
        unit = np.maximum(np.abs(self.scale[kept]), 1e-12)

        def state(x: Array) -> Array:
            y = begin.copy()
            y[free] = x[:-1] * scale
            return y

        def missing(x: Array) -> Array:
            rates = np.array(self.rates(0.0, state(x).tolist(), x[-1], self.flags))
            return 1e-9 * rates[kept] / unit

        start = np.append(begin[free] / scale, guess)
        start[:-1][[self.names[k] == "spool" for k in free]] = guess
        solved = root(missing, start, method="hybr")
        return (state(solved.x), float(solved.x[-1])) if solved.success else None

    def _known(self, name: str) -> bool:
        return name.replace("_", " ") in self.names

    def _with(self, states: Mapping[str, float]) -> Array:
        """The start with some states changed."""
        y = self.initial.copy()
        for name, value in states.items():
            y[self.names.index(name.replace("_", " "))] = value
        return y


@dataclass(frozen=True, slots=True)
class Ultimate:
    """Where a proportional loop begins to swing."""

    gain: float
    period: float
    """[s]"""


def ultimate(loop: OpenLoop) -> Ultimate:
    """Smallest gain with K L(i omega) = -1; infinite where none swings."""
    found = [(-1 / value.real, omega) for omega, value in _crossings(loop, loop.at)]
    gain, omega = min(found, default=(inf, 0.0))
    return Ultimate(gain, 2 * pi / omega if omega > 0 else inf)


def _crossings(loop: OpenLoop, response: Callable[[Array], Array]) -> list[tuple[float, complex]]:
    """Frequencies at which a response is real and negative."""
    from scipy.optimize import brentq

    omega = loop.frequencies
    value = response(omega)
    found = []
    for k in np.flatnonzero(np.diff(np.sign(value.imag)) != 0):
        if min(value[k].real, value[k + 1].real) >= 0:
            continue
        at = float(
            brentq(lambda w: float(response(np.array(w)).imag), omega[k], omega[k + 1], rtol=1e-12)
        )
        there = complex(response(np.array(at)))
        if there.real < 0:
            found.append((at, there))
    return found


@dataclass(frozen=True, slots=True)
class Law:
    """C(s) = K [1 + 1/(s T_i) + s T_d/(1 + s T_f)] of a controller."""

    gain: float
    integral_time: float
    derivative_time: float
    filter_time: float

    def at(self, omega: Array) -> Array:
        """C(i omega)."""
        s = 1j * np.asarray(omega, dtype=float)
        part = 1.0 + self.derivative_time * s / (1 + self.filter_time * s)
        if self.integral_time < inf:
            part = part + 1 / (s * self.integral_time)
        return self.gain * part

    def closed(self, loop: OpenLoop) -> Array:
        """Poles of the closed loop."""
        size = len(loop.poles)
        c, ones = loop.residues, np.ones(size)
        direct = self.gain * (1 + self.derivative_time / self.filter_time)
        a = np.zeros((size + 2, size + 2), dtype=complex)
        # u = -K [(1 + T_d/T_f) y + I/T_i - T_d/T_f f], I' = y, f' = (y - f)/T_f
        a[:size, :size] = np.diag(loop.poles) - direct * np.outer(ones, c)
        if self.integral_time < inf:
            a[:size, size] = -self.gain / self.integral_time
            a[size, :size] = c
        else:
            a[size, size] = -1 / self.filter_time
        a[:size, size + 1] = self.gain * self.derivative_time / self.filter_time
        a[size + 1, :size] = c / self.filter_time
        a[size + 1, size + 1] = -1 / self.filter_time
        return np.asarray(np.linalg.eigvals(a))


@dataclass(frozen=True, slots=True)
class Margins:
    """Margins of a loop with its controller."""

    gain: float
    """Factor on the gain at which it swings: above one where it is stable, else below."""
    phase: float | None
    """[rad]; None where the loop's gain never passes one."""
    stable: bool


def _grow(poles: Array) -> bool:
    """Whether a pole grows: any that swings, and a real one faster than creep."""
    size = np.abs(poles)
    swings = np.abs(poles.imag) > 1e-3 * size
    slowest = np.min(size[swings]) if swings.any() else np.max(size)
    limit = np.where(swings, ROUNDING * size, CREEP * slowest)
    return bool(np.any(poles.real > limit))


def margins(loop: OpenLoop, law: Law) -> Margins:
    """Gain and phase margin of L(i omega) C(i omega); its closed poles say whether it is stable."""

    def response(omega: Array) -> Array:
        return loop.at(omega) * law.at(omega)

    stable = not _grow(law.closed(loop))
    factors = [-1 / value.real for _, value in _crossings(loop, response)]
    if stable:
        gain = min((one for one in factors if one > 1), default=inf)
    else:
        gain = max((one for one in factors if one <= 1), default=0.0)
    omega = loop.frequencies
    value = response(omega)
    size = np.abs(value)
    phase = None
    for k in np.flatnonzero((size[:-1] >= 1) & (size[1:] < 1)):
        share = np.log(size[k]) / np.log(size[k] / size[k + 1])
        here = response(omega[k : k + 1] * (omega[k + 1] / omega[k]) ** share)[0]
        own = float(np.angle(-here))
        phase = own if phase is None or abs(own) < abs(phase) else phase
    return Margins(gain, phase, stable)


def least(loops: Sequence[OpenLoop]) -> tuple[Ultimate, OpenLoop]:
    """The loop that swings first; one that swings by itself before all."""
    found = [(Ultimate(0.0, inf) if one.swings else ultimate(one), one) for one in loops]
    return min(found, key=lambda pair: pair[0].gain)
