"""The lag of the pressures: whether a record shows one that may be taken off."""

from __future__ import annotations

from dataclasses import replace
from math import isfinite

from ..base.fitting import Parameter
from .doubtful import opened
from .lugre_problem import LuGreFit
from .lugre_windows import LAG

LEAST_LAG = 3e-4
"""Least lag that is worth taking off [s]."""
EARLIEST = 6e-3
"""Time by which pressures may come before the position [s] (a choice: filters of a position sensor
are late too, but bristles may look so)."""
STATE = "state --pressure-lag if it is known"
CANNOT = (
    "the record cannot show whether the pressures come late: raise --cutoff, turn the rod more "
    f"slowly, or {STATE}"
)


def lag_of(lugre: LuGreFit | str) -> Parameter | None:
    """The lag that a model found; None where none was looked for."""
    return None if isinstance(lugre, str) else lugre.parameters.get("lag")


def taken_off(found: Parameter | None) -> tuple[float, str]:
    """The lag to take off the pressures [s], 0 for none, and what to say of it.

    A lag is taken off where its 95 % bounds lie above zero. One below zero is none: sigma_0 z +
    sigma_1 dz/dt is sigma_0 z a time sigma_1/sigma_0 earlier, so micro-damping looks like pressures
    that come early. The record gives the difference of the two alone.

    Parameters
    ----------
    found : the lag as found, sigma_1 held at 0

    Returns
    -------
    the lag, and a note that may be empty
    """
    if found is None:
        return 0.0, ""
    value, lower, upper = (1e3 * x for x in found[:3])
    if not isfinite(upper - lower):
        return 0.0, CANNOT
    if not -EARLIEST <= found.value <= 0.99 * LAG:
        beyond = f"beyond {-1e3 * EARLIEST:g} to {1e3 * LAG:g} ms, where no sensor is"
        return 0.0, f"the reversals fit a lag {beyond}: none is taken off, {STATE}"
    bounds = f"{lower:.2f} to {upper:.2f}"
    if upper < 0:
        return 0.0, (
            f"friction leads the motion by {-value:.2f} ms ({-upper:.2f} to {-lower:.2f}): by "
            f"σ₁/σ₀, or a position that comes late; the record cannot tell which. No lag is taken "
            f"off, {STATE}"
        )
    if lower > 0 and found.value > LEAST_LAG:
        return found.value, (
            f"pressures come {value:.2f} ms late ({bounds}), by the reversals; taken off"
        )
    return 0.0, ""


def undone(found: Parameter, left: Parameter | None) -> str:
    """Why a lag that was taken off is put back: another one is left; else empty."""
    if left is None or left.lower <= 0 <= left.upper:
        return ""
    return (
        f"{1e3 * found.value:.2f} ms of lag taken off the pressures leave {1e3 * left.value:.2f} "
        f"ms: something else is fitted by it, and none is taken off; {STATE}"
    )


def unparted(lugre: LuGreFit | str) -> LuGreFit | str:
    """A model with sigma_1 of a record whose lag is not known: the two are not parted."""
    if isinstance(lugre, str):
        return lugre
    doubt = "σ₁ holds if no pressure comes late: a lag τ adds σ₀ τ"
    parameters = opened(lugre.parameters, ("bristle_damping",))
    return replace(lugre, parameters=parameters, doubts=(*lugre.doubts, doubt))
