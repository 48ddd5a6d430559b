"""A servo by its equations alone: ideal cylinder, four sharp edges that close, P control.

Nothing here comes from the package. SI, gauge pressures. The mass moves along the rod, or an arm
turns about a joint; the arm is integrated in its angle, not in the length of the cylinder.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import cos, sin, sqrt, tanh

import numpy as np
from scipy.integrate import solve_ivp

CREEP = 1e-6
"""Speed within which dry friction changes its sign [m/s]."""


@dataclass(frozen=True)
class Arm:
    """An arm between two pivots, whose moment of load grows with the angle between the radii."""

    base: float
    crank: float
    inertia: float
    moment: Callable[[float], float]
    closed: float

    def length(self, angle: float) -> float:
        """Length of the cylinder, law of cosines."""
        a, r = self.base, self.crank
        return sqrt(a * a + r * r - 2 * a * r * cos(angle))

    def lever(self, angle: float) -> float:
        """Change of the length per angle."""
        return self.base * self.crank * sin(angle) / self.length(angle)


@dataclass(frozen=True)
class PlainServo:
    """Numbers of a circuit; `gain` is in V/m, the full signal 10 V."""

    areas: tuple[float, float]
    dead: tuple[float, float]
    stroke: float
    modulus: float
    edge: float
    """Flow of an edge at full signal per root of its pressure drop."""
    supply: float
    back: float
    gain: float
    reference: Callable[[float], float]
    mass: float = 0.0
    viscous: float = 0.0
    dry: float = 0.0
    load: Callable[[float], float] = lambda time: 0.0
    spool: tuple[float, float] = (80.0, 0.8)
    arm: Arm | None = None
    volumes: tuple[float, float] | None = None
    """Volumes that do not change as the piston moves."""

    def _flow(self, opening: float, drop: float) -> float:
        way = 1.0 if drop > 0 else -1.0
        return self.edge * max(opening, 0.0) / 10.0 * way * sqrt(abs(drop))

    def rates(self, time: float, state: Sequence[float]) -> list[float]:
        """Rates of place (or angle), its speed, both pressures, spool and its speed."""
        place, turn, a, b, spool, slew = state
        lever = 1.0 if self.arm is None else self.arm.lever(place)
        x = place if self.arm is None else self.arm.length(place) - self.arm.closed
        v = turn * lever
        wanted = self.gain * (self.reference(time) - x)
        natural = 2 * np.pi * self.spool[0]
        command = min(max(wanted, -10.0), 10.0)
        into_a = self._flow(spool, self.supply - a) - self._flow(-spool, a - self.back)
        into_b = self._flow(-spool, self.supply - b) - self._flow(spool, b - self.back)
        area_a, area_b = self.areas
        oil_a = self.dead[0] + area_a * x
        oil_b = self.dead[1] + area_b * (self.stroke - x)
        oil_a, oil_b = self.volumes or (oil_a, oil_b)
        push = a * area_a - b * area_b - self.viscous * v - self.dry * tanh(v / CREEP)
        if self.arm is None:
            quickening = (push - self.load(time)) / self.mass
        else:
            quickening = (push * lever - self.arm.moment(place)) / self.arm.inertia
        return [
            turn,
            quickening,
            self.modulus / oil_a * (into_a - area_a * v),
            self.modulus / oil_b * (into_b + area_b * v),
            slew,
            natural * (natural * (command - spool) - 2 * self.spool[1] * slew),
        ]

    def run(
        self,
        place: float,
        pressures: tuple[float, float],
        times: np.ndarray,
        jumps: Sequence[float],
    ) -> dict[str, np.ndarray]:
        """Position and pressures at times; the integration restarts at the jumps."""
        edges = [0.0, *jumps, float(times[-1])]
        state, parts = [place, 0.0, *pressures, 0.0, 0.0], []
        for begin, end in pairwise(edges):
            last = end == edges[-1]
            at = times[(times >= begin) & ((times < end) | last)]

            def inside(time: float, state: Sequence[float], end: float = end) -> list[float]:
                return self.rates(min(time, np.nextafter(end, 0.0)), state)

            done = solve_ivp(
                inside, (begin, end), state, "Radau", dense_output=True,
                rtol=1e-7, atol=[1e-10, 1e-9, 1.0, 1.0, 1e-7, 1e-4],
            )  # fmt: skip
            parts.append(done.sol(at))
            state = done.y[:, -1]
        path, _, a, b, _, _ = np.concatenate(parts, axis=1)
        if self.arm is not None:
            path = np.array([self.arm.length(angle) for angle in path]) - self.arm.closed
        return {"position": path, "pressure_a": a, "pressure_b": b}
