"""The simulation against an oracle written apart from it, and against laws of its own.

Both get the same numbers; states and energies agree within millionths of their span.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
import pytest
import servo_oracle as oracle
import servo_oracle_parts as parts
from servo_oracle_parts import line, sine, steps
from simulation_case import AREA_A, AREA_B, BAR, BALANCED, LITRE, MIDDLE, OIL, VALVE, plant, run
from simulation_case import scenario

from actuator_opt.evaluation.study.plant import Plane, SealData
from actuator_opt.models.tuning import ControllerGains

SHARP = {"sharp": 1e3, "relative": 1e-9}
HOLD = 70 * BAR * (AREA_A - AREA_B)
AIRY = replace(OIL, air_content=0.01)
STUCK = SealData(Plane(150.0), Plane(200.0), 0.01, 2.0, 0.0, 2e-4)
STARTS = {"position": "position", "pressure_a": "p_a", "pressure_b": "p_b", "speed": "velocity"}


@dataclass(frozen=True)
class Tapered(parts.LuGre):
    """Bristles whose damping fades with the speed, as it must to stay passive."""

    taper: float = math.inf

    def rate_and_force(self, v, z):
        """Bristle rate and friction force."""
        rate, _ = super().rate_and_force(v, z)
        return rate, self.sigma0 * z + self.sigma1 * math.exp(-((v / self.taper) ** 2)) * rate


@dataclass(frozen=True)
class Seat(parts.FixedPump):
    """A fixed pump whose relief valve is an orifice that opens in proportion."""

    override: float = 10 * BAR
    rated: float = 0.0
    tank: float = 0.0

    def rates(self, p, q, used):
        """Rates of pressure and pump flow; flow delivered and flow through the relief valve."""
        drop = p - self.tank
        share = min(max((drop - self.relief_pressure) / self.override, 0.0), 1.0)
        full = self.rated * math.sqrt(max(drop, 0.0) / (self.relief_pressure + self.override))
        flow = share * full
        return (self.flow - used - flow) * self.bulk_modulus / self.volume, 0.0, self.flow, flow


def twin(own, *, reference, load, controller=None, supply=None, damping=0.0):
    """The oracle's circuit of a plant; `damping` of its bristles."""
    valve, seals = own.valve, own.seals
    friction = None
    if seals.coulomb.constant > 0:
        stiffness = seals.static.constant / seals.bristle_travel
        taper = 2 * seals.coulomb.constant / damping if damping else math.inf
        friction = Tapered(
            seals.static.constant, seals.coulomb.constant, seals.stribeck_speed, stiffness,
            damping, taper=taper,
        )  # fmt: skip
    cylinder = parts.Cylinder(
        own.area_a, own.area_b, own.stroke, own.dead_a, own.dead_b, own.mass,
        leakage=own.leakage, viscous=own.oil_damping, friction=friction,
        stop_stiffness=own.stop_stiffness,
        stop_damping=0.5 * math.sqrt(own.stop_stiffness * own.mass),
    )  # fmt: skip
    return oracle.Circuit(
        parts.Oil(own.oil.bulk_modulus, own.oil.air_content, ambient=101325.0),
        parts.Valve(
            valve.rated, 2 * (valve.leakage_supply, valve.leakage_tank),
            2 * math.pi * valve.natural_frequency, valve.damping_ratio, valve.signal,
        ),
        cylinder,
        parts.ConstantSupply(own.supply_pressure) if supply is None else supply,
        reference,
        load,
        controller,
        own.return_pressure,
    )  # fmt: skip


def gains_of(controller):
    """The controller in our form."""
    integral = controller.kp / controller.ki if controller.ki else math.inf
    return ControllerGains(controller.kp, integral, controller.kd / controller.kp)


def apart(ours, theirs, names):
    """Largest difference of states and integrals over their span, by our name."""
    _, first = np.unique(ours.time, return_index=True)
    both = theirs.signals | theirs.integrals
    found = {}
    for mine, other in names.items():
        values = ours.signals[mine] if mine in ours.signals else ours.state(mine)
        other = both[other] if isinstance(other, str) else other(both)
        found[mine] = float(np.abs(values[first] - other).max() / np.ptp(other))
    return found


MOVED = {
    "position": "position", "speed": "velocity", "pressure_a": "p_a", "pressure_b": "p_b",
    "spool": "spool", "flow_a": "q_a", "flow_supply": "q_p",
    "valve loss": lambda both: sum(both[f"edge_{e}"] for e in ("pa", "at", "pb", "bt")),
    "work on load": "load",
}  # fmt: skip
PULSE = {"signal": [{"shape": "pulse", "start": 0.02, "end": 0.1, "value": 6.0}]}
CONTROL = {"tuning": "stated", "position_gain": 1.0}
