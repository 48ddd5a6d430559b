"""The parts of a servo circuit for its oracle, each written straight from the physics.

Nothing here comes from the package. SI, gauge pressures. A cylinder and a motor answer to the
same names: the motor's displacement per radian is its area on both sides, its oil volumes are
the pipes and do not change, its position is the angle.
"""

import math
from bisect import bisect_right
from collections.abc import Callable
from dataclasses import dataclass
from typing import ClassVar, Literal

Piece = Callable[[float], tuple[float, float]]
SMOOTHING_SQUARED = 1e8  # Pa^2: the edge law is linear below about 1e4 Pa


@dataclass(frozen=True)
class Signal:
    """A function of time in smooth pieces; each gives (value, rate) from its start on."""

    starts: tuple[float, ...]
    pieces: tuple[Piece, ...]

    def piece(self, time: float) -> Piece:
        """Give the piece that holds just after a time."""
        return self.pieces[max(bisect_right(self.starts, time) - 1, 0)]


def line(value: float, rate: float = 0.0, start: float = 0.0) -> Piece:
    """Give a straight piece: `value` at `start`, growing at `rate`."""
    return lambda time: (value + rate * (time - start), rate)


def sine(mean: float, amplitude: float, frequency: float) -> Piece:
    """Give a sine piece, frequency in Hz."""
    w = 2 * math.pi * frequency
    return lambda time: (
        mean + amplitude * math.sin(w * time),
        amplitude * w * math.cos(w * time),
    )


def steps(*points: tuple[float, float]) -> Signal:
    """Give a stair of (start, value) points."""
    return Signal(tuple(start for start, _ in points), tuple(line(value) for _, value in points))


@dataclass(frozen=True)
class Oil:
    """Oil of constant modulus with a fixed mass of polytropic air in it."""

    bulk_modulus: float
    air: float = 0.0  # volume of air per volume of oil, both at ambient pressure
    exponent: float = 1.4
    ambient: float = 1.013e5

    def _parts(self, p: float) -> tuple[float, float, float]:
        absolute = max(p + self.ambient, 1.0)
        air = self.air * (self.ambient / absolute) ** (1 / self.exponent) if self.air else 0.0
        return math.exp(-p / self.bulk_modulus), air, absolute

    def density_ratio(self, p: float) -> float:
        """Density over the density at zero gauge pressure."""
        oil, air, _ = self._parts(p)
        return (1 + self.air) / (oil + air)

    def modulus(self, p: float) -> float:
        """-V dp/dV of the mixture."""
        oil, air, absolute = self._parts(p)
        return (oil + air) / (oil / self.bulk_modulus + air / (self.exponent * absolute))


@dataclass(frozen=True)
class Valve:
    """Four edges; a positive spool voltage opens P-A and B-T."""

    full: float  # m^3/s/sqrt(Pa) of an edge at the limit
    leakage: tuple[float, float, float, float]  # the same of the closed edges PA, AT, PB, BT
    spool_frequency: float  # rad/s
    spool_damping: float = 0.7
    limit: float = 10.0  # V

    def edges(
        self, spool: float, ps: float, pa: float, pb: float, pt: float, side: float = 0.0
    ) -> tuple[float, float, float, float]:
        """Flows PA, AT, PB, BT; `side` freezes the branch of |spool| for slopes at zero."""
        side = side or math.copysign(1.0, spool)
        share = side * spool / self.limit
        opens = (side > 0, side < 0, side < 0, side > 0)

        def edge(i: int, drop: float) -> float:
            k = self.leakage[i]
            k += (self.full - k) * share if opens[i] else 0.0
            return float(k * drop / (drop * drop + SMOOTHING_SQUARED) ** 0.25)

        return edge(0, ps - pa), edge(1, pa - pt), edge(2, ps - pb), edge(3, pb - pt)


@dataclass(frozen=True)
class LuGre:
    """Bristle friction without its viscous part, which belongs to the cylinder."""

    static: float
    coulomb: float
    stribeck_velocity: float
    sigma0: float
    sigma1: float = 0.0
    exponent: float = 2.0

    def rate_and_force(self, v: float, z: float) -> tuple[float, float]:
        """Bristle rate and friction force."""
        fall = math.exp(-((abs(v) / self.stribeck_velocity) ** self.exponent))
        level = self.coulomb + (self.static - self.coulomb) * fall
        rate = v - self.sigma0 * abs(v) * z / level
        return rate, self.sigma0 * z + self.sigma1 * rate


@dataclass(frozen=True)
class Cylinder:
    """Two chambers, a piston with its load mass, two end stops that only push."""

    area_a: float
    area_b: float
    stroke: float
    dead_a: float
    dead_b: float
    mass: float
    leakage: float = 0.0  # m^3/s/Pa past the piston
    viscous: float = 0.0  # sigma2
    friction: LuGre | None = None
    stop_stiffness: float = 1e9
    stop_damping: float = 0.0
    carried: ClassVar[float] = 0.0  # oil that leaves the volumes with the motion

    def volumes(self, x: float) -> tuple[float, float]:
        """Chamber volumes at a position."""
        return self.dead_a + self.area_a * x, self.dead_b + self.area_b * (self.stroke - x)

    def resistance(self, v: float, z: float, pa: float, pb: float) -> tuple[float, float]:
        """Bristle rate and friction force."""
        rate, force = self.friction.rate_and_force(v, z) if self.friction else (0.0, 0.0)
        return rate, force + self.viscous * v

    def stops(self, x: float, v: float) -> tuple[float, float, float, float]:
        """Spring-damper forces of cap and rod end, and the same limited by the gap."""
        k, b = self.stop_stiffness, self.stop_damping
        cap, rod = -k * x - b * v, k * (x - self.stroke) + b * v
        return cap, rod, min(cap, -k * x), min(rod, k * (x - self.stroke))


@dataclass(frozen=True)
class Motor:
    """Wilson motor between two pipes; position is the angle, mass the inertia."""

    displacement: float  # m^3/rad
    mass: float
    pipe_volume: float
    slip: float = 0.0  # C_s
    dry: float = 0.0  # C_f
    viscous_drag: float = 0.0  # C_v
    constant_torque: float = 0.0  # T_c
    viscosity: float = 1.0  # dynamic
    setting: float = 1.0
    carried: ClassVar[float] = 1.0
    friction: ClassVar[None] = None

    @property
    def area_a(self) -> float:
        """Displacement in use."""
        return self.setting * self.displacement

    area_b = area_a

    @property
    def leakage(self) -> float:
        """Slip per pressure drop."""
        return self.slip * self.displacement / self.viscosity

    def volumes(self, x: float) -> tuple[float, float]:
        """Pipe volumes."""
        return self.pipe_volume, self.pipe_volume

    def resistance(self, v: float, z: float, pa: float, pb: float) -> tuple[float, float]:
        """No bristle; friction torque."""
        dry = self.dry * self.displacement * abs(pa - pb) + self.constant_torque
        drag = self.viscous_drag * self.viscosity * self.displacement * v
        return 0.0, math.tanh(v / 0.5) * dry + drag

    def stops(self, x: float, v: float) -> tuple[float, float, float, float]:
        """No stops."""
        return 0.0, 0.0, -1.0, -1.0


@dataclass(frozen=True)
class ConstantSupply:
    """A supply of constant pressure."""

    pressure: float

    def rates(self, p: float, q: float, used: float) -> tuple[float, float, float, float]:
        """Rates of pressure and pump flow; flow delivered and flow through a relief valve."""
        return 0.0, 0.0, used, 0.0


@dataclass(frozen=True)
class FixedPump:
    """A constant flow into a line; the relief valve opens in proportion above its setting."""

    flow: float
    relief_pressure: float
    relief_slope: float  # m^3/s/Pa
    volume: float
    bulk_modulus: float
    pressure: float = 0.0  # at the start

    def rates(self, p: float, q: float, used: float) -> tuple[float, float, float, float]:
        """As for the constant supply."""
        relief = self.relief_slope * max(p - self.relief_pressure, 0.0)
        return (self.flow - used - relief) * self.bulk_modulus / self.volume, 0.0, self.flow, relief


@dataclass(frozen=True)
class ControlledPump:
    """First-order pressure control: tau dq/dt = gain (setting - p) - q, delivery clipped."""

    time_constant: float
    gain: float
    setting: float
    largest_flow: float
    volume: float
    bulk_modulus: float
    pressure: float = 0.0  # at the start

    def rates(self, p: float, q: float, used: float) -> tuple[float, float, float, float]:
        """As for the constant supply."""
        given = min(max(q, 0.0), self.largest_flow)
        q_rate = (self.gain * (self.setting - p) - q) / self.time_constant
        return (given - used) * self.bulk_modulus / self.volume, q_rate, given, 0.0


@dataclass(frozen=True)
class Controller:
    """PID on the error; the derivative acts on the filtered error."""

    kp: float
    ki: float = 0.0
    kd: float = 0.0
    filter_time: float = 1e-3
    of: Literal["position", "velocity"] = "position"
