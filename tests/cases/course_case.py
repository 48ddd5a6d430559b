"""The circuits of the course MEC-E5005 for its tests: closed forms, and the oracle's circuits.

Written from the slides and the assumptions of the shipped files; nothing here is computed by the
package.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
import servo_oracle_parts as parts
from scipy.optimize import brentq, fsolve
from servo_oracle import Circuit

BAR, LITRE, RPM = 1e5, 1 / 60000, math.pi / 30
SUPPLY = 100 * BAR
AREA_A, AREA_B = math.pi * 0.032**2 / 4, math.pi * (0.032**2 - 0.018**2) / 4
FULL, LEAK = 40 * LITRE / math.sqrt(35 * BAR), 0.45 * LITRE / math.sqrt(50 * BAR)
COULOMB, STATIC, STRIBECK, VISCOUS = 500.0, 1000.0, 0.02, 1000.0
MASS, BULK, STROKE, DEAD = 234.0, 1.4e9, 0.4, 8e-6
SIGMA_0 = STATIC / 0.1e-3
SIGMA_1 = math.sqrt(SIGMA_0 * MASS)
SPOOL, SPOOL_DAMPING = 2 * math.pi * 60, 0.7
V_R, INERTIA, PIPE = 13.3e-6 / (2 * math.pi), 3.3e-3 + 10e-3, math.pi / 4 * 0.012**2 * 0.75
SLIP, DRY, DRAG, CONSTANT = 150e-9, 0.16, 100e3, 0.1
VISCOSITY = 32e-6 * 870
LOAD = 5.0


def leak(bar: float) -> float:
    """Coefficient of a closed edge that passes 0.45 l/min at a drop."""
    return 0.45 * LITRE / math.sqrt(bar * BAR)


def edges(
    volts: float, full: float = FULL, into: float = LEAK, out: float = LEAK
) -> tuple[float, float, float, float]:
    """Coefficients of PA, AT, PB, BT at a voltage; `into` and `out` are those at the centre."""
    share = abs(volts) / 10
    opened = [closed + (full - closed) * share for closed in (into, out)]
    if volts >= 0:
        return opened[0], out, into, opened[1]
    return into, opened[1], opened[0], out


def root(drop: float) -> float:
    """Square root with the sign of the drop."""
    return math.copysign(math.sqrt(abs(drop)), drop)


def flows(volts: float, p_a: float, p_b: float, *edge: float) -> tuple[float, float]:
    """Into A and into B; `edge` as for `edges`."""
    pa, at, pb, bt = edges(volts, *edge)
    return pa * root(SUPPLY - p_a) - at * root(p_a), pb * root(SUPPLY - p_b) - bt * root(p_b)


def friction(speed: float) -> float:
    """Of steady sliding: the slides' curve."""
    level = COULOMB + (STATIC - COULOMB) * math.exp(-((speed / STRIBECK) ** 2))
    return math.copysign(level, speed) + VISCOUS * speed


def steady(volts: float, guess: float, *edge: float) -> tuple[float, float, float]:
    """Speed and pressures by q_A = A_A v, q_B = -A_B v and the balance of forces."""

    def missing(x: np.ndarray) -> list[float]:
        speed, p_a, p_b = x[0], x[1] * BAR, x[2] * BAR
        q_a, q_b = flows(volts, p_a, p_b, *edge)
        force = p_a * AREA_A - p_b * AREA_B - friction(speed)
        return [1e4 * (q_a - AREA_A * speed), 1e4 * (q_b + AREA_B * speed), 1e-3 * force]

    found, _, done, why = fsolve(missing, [guess, 45.0, 60.0], full_output=True, xtol=1e-13)
    assert done == 1, why
    return float(found[0]), float(found[1]) * BAR, float(found[2]) * BAR


def holding_signal(force: float) -> float:
    """Signal that holds the piston still against a force, from the two dividers of pressure.

    p_A = p_S/(1 + r) and p_B = p_S r/(1 + r) with r = (K_open/K_0)^2, the spool on the side that
    opens A to the tank.
    """
    ratio = (SUPPLY * AREA_A - force) / (SUPPLY * AREA_B + force)
    return -(math.sqrt(ratio) - 1) * LEAK * 10 / (FULL - LEAK)


# ---- the motor ----


@dataclass(frozen=True)
class Running:
    """The motor at a steady speed."""

    volts: float
    p_a: float
    p_b: float


def running(speed: float, load: float = LOAD, dry: float = DRY, constant: float = CONSTANT):
    """Signal and pressures of a steady speed, from torque, then flow, then the valve's edges."""
    sense = math.tanh(speed / 0.5)
    drag = DRAG * VISCOSITY * V_R * speed
    across = (load + constant * sense + drag) / (V_R * (1 - dry * sense))
    needed = V_R * speed + SLIP * V_R / VISCOSITY * across
    p_a, p_b = (SUPPLY + across) / 2, (SUPPLY - across) / 2

    def short(volts: float) -> float:
        return flows(volts, p_a, p_b)[0] - needed

    return Running(float(brentq(short, 0.0, 10.0, xtol=1e-14)), p_a, p_b)


def motor_swings(speed: float, load: float = LOAD, dry: float = DRY, constant: float = CONSTANT):
    """Gain [V s/rad] and period at which the speed loop swings about a steady speed.

    The five states p_A, p_B, w, o, o' by hand; the gain by its characteristic polynomial.
    """
    at = running(speed, load, dry, constant)
    pa, side_at, pb, bt = edges(at.volts)
    c_a = pa / (2 * math.sqrt(SUPPLY - at.p_a)) + side_at / (2 * math.sqrt(at.p_a))
    c_b = pb / (2 * math.sqrt(SUPPLY - at.p_b)) + bt / (2 * math.sqrt(at.p_b))
    per_volt = (FULL - LEAK) / 10
    g_a, g_b = per_volt * math.sqrt(SUPPLY - at.p_a), per_volt * math.sqrt(at.p_b)
    slip, spring = SLIP * V_R / VISCOSITY, BULK / PIPE
    sense = math.tanh(speed / 0.5)
    torque = V_R * (1 - dry * sense)
    slope = (1 - sense**2) / 0.5 * (dry * V_R * (at.p_a - at.p_b) + constant)
    drag = DRAG * VISCOSITY * V_R + slope
    a = np.array(
        [
            [-spring * (c_a + slip), spring * slip, -spring * V_R, spring * g_a, 0],
            [spring * slip, -spring * (c_b + slip), spring * V_R, -spring * g_b, 0],
            [torque / INERTIA, -torque / INERTIA, -drag / INERTIA, 0, 0],
            [0, 0, 0, 0, 1],
            [0, 0, 0, -(SPOOL**2), -2 * SPOOL_DAMPING * SPOOL],
        ]
    )
    return swings(a, np.array([0, 0, 0, 0, SPOOL**2]), np.array([0, 0, 1.0, 0, 0]))


def swings(a: np.ndarray, b: np.ndarray, c: np.ndarray) -> tuple[float, float]:
    """Smallest gain that puts a pair of poles of a - k b c on the axis, and its period."""

    def most(gain: float) -> complex:
        poles = np.linalg.eigvals(a - gain * np.outer(b, c))
        swinging = poles[np.abs(poles.imag) > 1e-6 * np.abs(poles).max()]
        return max(swinging, key=lambda one: one.real)

    gain = 1e-3
    while most(1.02 * gain).real < 0:
        gain *= 1.02
    found = float(brentq(lambda k: most(k).real, gain, 1.02 * gain, xtol=1e-12, rtol=1e-12))
    return found, 2 * math.pi / abs(most(found).imag)


def velocity_gain(p_a: float, p_b: float, extend: bool) -> float:
    """Steady speed per signal about rest [m/s/V], bristles left out: three linear equations."""
    c_a = LEAK / 2 * (1 / math.sqrt(SUPPLY - p_a) + 1 / math.sqrt(p_a))
    c_b = LEAK / 2 * (1 / math.sqrt(SUPPLY - p_b) + 1 / math.sqrt(p_b))
    per_volt = (FULL - LEAK) / 10
    g_a = per_volt * math.sqrt(SUPPLY - p_a if extend else p_a)
    g_b = per_volt * math.sqrt(p_b if extend else SUPPLY - p_b)
    matrix = [[AREA_A, c_a, 0], [-AREA_B, 0, c_b], [-VISCOUS, AREA_A, -AREA_B]]
    return float(np.linalg.solve(matrix, [g_a, -g_b, 0.0])[0])


# ---- the oracle's circuits ----


@dataclass(frozen=True)
class Tapered(parts.LuGre):
    """Bristles whose damping fades with speed, by half the speed to which it is passive."""

    viscous: float = VISCOUS

    def rate_and_force(self, v: float, z: float) -> tuple[float, float]:
        """Bristle rate and friction force."""
        rate, _ = super().rate_and_force(v, z)
        passive = 4 * self.coulomb * (self.sigma1 + self.viscous) / self.sigma1**2
        return rate, self.sigma0 * z + self.sigma1 * math.exp(-((2 * v / passive) ** 2)) * rate


OIL = parts.Oil(BULK, air=1e-4, ambient=101325.0)
VALVE = parts.Valve(FULL, (LEAK,) * 4, SPOOL, SPOOL_DAMPING)
BRISTLES = Tapered(STATIC, COULOMB, STRIBECK, SIGMA_0, SIGMA_1)
SLIDES = parts.Cylinder(
    AREA_A, AREA_B, STROKE, DEAD, DEAD, MASS, viscous=VISCOUS, friction=BRISTLES,
    stop_stiffness=AREA_A * SUPPLY / 0.2e-3,
)  # fmt: skip
MOTOR = parts.Motor(V_R, INERTIA, PIPE, SLIP, DRY, DRAG, CONSTANT, VISCOSITY)
CYLINDER = Circuit(OIL, VALVE, SLIDES, parts.ConstantSupply(SUPPLY), parts.steps((0.0, 0.0)))
TURNING = replace(CYLINDER, actuator=MOTOR, load=parts.steps((0.0, LOAD)))
