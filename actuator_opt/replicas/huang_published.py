"""Seal damping that [Huang2017] prints, checked with the numbers of the paper.

Table 2 (in `models.friction`) replaces the measured curves, whose figures have no numbers. All
values are in SI. The text copy that was read has lost leading minus signs (eq. 2 and 31). The
printed conditions b > 0 of its two fits may therefore mean exponents -b; as printed they cannot
hold.
"""

from __future__ import annotations

from dataclasses import asdict
from typing import NamedTuple

import numpy as np

from ..base.dataclass import dataclass
from ..base.numeric import Array
from ..design.material import LawFit, fit_double_exponential, fit_power_law
from ..models import damping, forces, friction
from ..models.friction import HUANG_TABLE_2, StribeckParameters
from .papers import published_numbers


@dataclass(frozen=True, slots=True)
class HuangPaper:
    """Values printed in the paper besides table 2, SI; ``notes/huang.yaml`` states where."""

    bore: float
    rod: float
    stroke: float
    plunger: float
    speeds: tuple[float, float]
    shown_speed: float
    shown_pressure: float
    pressures: tuple[float, float]
    claimed: tuple[float, float]
    compared: float
    simulated: tuple[float, float]
    tightest: float
    ring_speeds: tuple[float, float, float]
    chamber_shear: float
    dry_friction: tuple[float, float]
    interpolation: tuple[float, float]

    @property
    def plunger_area(self) -> float:
        """Area that the chamber pressure of test B acts on."""
        return float(forces.piston_area(bore=self.plunger))


PAPER = published_numbers(HuangPaper, "huang")

SPEEDS = np.linspace(*PAPER.speeds, 20)
"""Speeds of the curves in figures 7 and 15, chosen by us within the paper's range."""

TOLERANCE = 0.15
"""Relative error up to which a printed value counts as confirmed."""

SEAL_VISCOSITY = 0.043
"""Viscosity in the rod-seal studies from which the paper takes its friction (Pa s)."""


def friction_of(row: StribeckParameters, speed: Array) -> Array:
    """Friction of the plunger at one of table 2's pressures and at speeds > 0."""
    curve = {key: value for key, value in asdict(row).items() if key != "pressure"}
    return friction.stribeck(speed=speed, **curve)


def secant_of(row: StribeckParameters, speed: Array) -> Array:
    """Secant viscous damping coefficient of the plunger, eq. 31."""
    return damping.secant(friction=friction_of(row, speed), speed=speed)


class DampingClaim(NamedTuple):
    """The printed fall from 0.65 to 0.2 MN s/m, compared with table 2 at a speed."""

    speed: float
    low: float
    """Damping B at 0.6 MPa."""
    high: float
    """Damping B at 6 MPa."""
    errors: tuple[float, float]
    """Relative errors of the claimed values: `low` and `high` / claimed value - 1."""
    bend: float
    """Largest relative deviation of B at 2 and 4 MPa from the straight line."""


def claim_at(speed: float) -> DampingClaim:
    """Compare the printed linear fall of damping with table 2 at a speed."""
    pressures = np.array([row.pressure for row in HUANG_TABLE_2])
    dampings = np.array([float(secant_of(row, speed)) for row in HUANG_TABLE_2])
    line = np.interp(pressures, pressures[[0, -1]], dampings[[0, -1]])
    errors = (dampings[0] / PAPER.claimed[0] - 1, dampings[-1] / PAPER.claimed[1] - 1)
    return DampingClaim(
        speed=speed,
        low=float(dampings[0]),
        high=float(dampings[-1]),
        errors=(float(errors[0]), float(errors[1])),
        bend=float(np.max(np.abs(dampings / line - 1))),
    )


def claim_speeds(tolerance: float = TOLERANCE) -> tuple[float, float]:
    """Least and largest speed at which both printed values agree with table 2, within a tolerance.

    B falls with speed, so each value agrees between two speeds. If these two ranges do not overlap,
    the result is in descending order.
    """
    speeds = np.geomspace(1e-4, 0.1, 200_001)
    slowest, fastest = 0.0, np.inf
    for row, value in zip((HUANG_TABLE_2[0], HUANG_TABLE_2[-1]), PAPER.claimed, strict=True):
        curve = secant_of(row, speeds)
        most, least = value * (1 + tolerance), value * (1 - tolerance)
        slow, fast = np.interp([-most, -least], -curve, speeds)
        slowest, fastest = max(slowest, float(slow)), min(fastest, float(fast))
    return slowest, fastest


def asymptote_speed(row: StribeckParameters, excess: float = 0.1) -> float:
    """Speed F_C/(excess sigma2) above which B <= (1 + excess) sigma2.

    F_C is the Coulomb friction, sigma2 the viscous coefficient; the Stribeck part has decayed.
    """
    return row.coulomb / (excess * row.viscous)


def viscous_share(row: StribeckParameters, speed: float) -> float:
    """Share of the viscous part sigma2 v in the friction."""
    return float(row.viscous * speed / friction_of(row, speed))


def balance_error(speed: float) -> float:
    """Fall of friction from 0.6 to 6 MPa, as a share of the change of pressure force.

    Friction is measured as the chamber's pressure force minus the load's (eq. 1). A relative error
    of this size in the pressure force would look like the whole fall.
    """
    first, last = HUANG_TABLE_2[0], HUANG_TABLE_2[-1]
    fall = float(friction_of(first, speed) - friction_of(last, speed))
    return fall / (PAPER.plunger_area * (last.pressure - first.pressure))


class CurveFits(NamedTuple):
    """Both laws of the paper fitted to one pressure of table 2."""

    row: StribeckParameters
    power: LawFit
    double: LawFit


def fitted(row: StribeckParameters, *, relative: bool = False) -> CurveFits:
    """Fits over the tested speeds, with equal weights or (`relative`) with relative errors."""
    curve = secant_of(row, SPEEDS)
    weights = 1 / curve**2 if relative else None
    return CurveFits(
        row,
        fit_power_law(SPEEDS, curve, weights),
        fit_double_exponential(SPEEDS, curve, weights),
    )


class Chamber(NamedTuple):
    """Inputs of eq. 24 and 25 that give the printed shear of the chamber."""

    viscosity: float
    length: float
    """Length of the plunger inside the chamber's oil."""
    gap: float
    """Height h_v of a thin gap."""
    gap_annular: float
    """The gap r_o - r_i (outer minus inner radius) if its curvature is included."""


def chamber(*, length: float, viscosity: float = SEAL_VISCOSITY) -> Chamber:
    """Gap that gives the printed shear for a given length and viscosity.

    It satisfies L eta/h_v = B/(pi d): length L, viscosity eta, gap h_v, damping B, diameter d.
    """
    thin = damping.flat_gap(
        dynamic_viscosity=viscosity, diameter=PAPER.plunger, length=length, gap=1.0
    )
    gap = float(thin) / PAPER.chamber_shear
    return Chamber(
        viscosity, length, gap, PAPER.plunger / 2 * float(np.expm1(2 * gap / PAPER.plunger))
    )


def chamber_length(*, gap: float, viscosity: float = SEAL_VISCOSITY) -> float:
    """Length of plunger in oil that gives the printed shear for a given gap."""
    return gap / chamber(length=1.0, viscosity=viscosity).gap


def plausible_chamber() -> Chamber:
    """A plausible chamber: length 560 mm, the only printed stroke, and viscosity 0.043 Pa s.

    The paper gives no length, viscosity or gap of the plunger's chamber; only the gap is fitted.
    """
    return chamber(length=PAPER.stroke)
