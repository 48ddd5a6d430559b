"""Friction coefficient times contact load, with the Stribeck curve."""

from __future__ import annotations

from ..base.numeric import Array
from ..models import friction
from ..seals.contact import SealContact
from ..seals.seal_type import SealSizes
from .law import FrictionLaw

STRIBECK_EXPONENT = 2.0
"""Default exponent of the Stribeck curve ([MECE5005], [Huang2017] Table 2)."""


def _coefficient(seal: SealSizes, contact: SealContact) -> Array:
    return seal["friction_coefficient"]


def _breakaway(seal: SealSizes, coulomb: Array) -> Array:
    return friction.breakaway(running=coulomb, ratio=seal["breakaway_ratio"])


def _curve(seal: SealSizes, coulomb: Array, speed: Array) -> dict[str, Array]:
    return {
        "speed": speed,
        "coulomb": coulomb,
        "static": _breakaway(seal, coulomb),
        "stribeck_speed": seal["stribeck_speed"],
        "exponent": STRIBECK_EXPONENT,
    }


def _level(seal: SealSizes, coulomb: Array, speed: Array) -> Array:
    return friction.stribeck_level(**_curve(seal, coulomb, speed))


def _slope(seal: SealSizes, coulomb: Array, speed: Array) -> Array:
    return friction.stribeck_slope(**_curve(seal, coulomb, speed), viscous=0.0)


LAW = FrictionLaw(
    name="coefficient",
    help="friction coefficient times contact load, with the Stribeck curve",
    compound=(),
    coefficient=_coefficient,
    breakaway=_breakaway,
    level=_level,
    slope=_slope,
    film=None,
    model=friction.stribeck_level,
)
