"""Lag of the pressures: whether a record shows one that can be corrected."""

from __future__ import annotations

from dataclasses import replace
from math import isfinite

from ..base.fitting import Parameter
from .doubtful import opened
from .lugre import LAG, LuGreFit

LEAST_LAG = 3e-4
"""Least lag worth correcting [s]."""
EARLIEST = 6e-3
"""Largest lead of the pressures over the position [s] (a choice: filters of a position sensor also
have a lag, but bristles may look the same)."""
STATE = "state --pressure-lag if it is known"
CANNOT = (
    "the record cannot show whether the pressures lag: raise --cutoff, reverse the rod more "
    f"slowly, or {STATE}"
)


def lag_of(lugre: LuGreFit | str) -> Parameter | None:
    """The lag that a model found; None if none was fitted."""
    return None if isinstance(lugre, str) else lugre.parameters.get("lag")


def taken_off(found: Parameter | None) -> tuple[float, str]:
    """The lag to correct [s], 0 for none, with a note.

    A lag is corrected if its 95 % bounds lie above zero. A negative one is not: sigma_0 z + sigma_1
    dz/dt is sigma_0 z advanced by sigma_1/sigma_0, so micro-damping looks like early pressures. The
    record only gives the difference of the two.

    Parameters
    ----------
    found : the lag as fitted, with sigma_1 fixed at 0

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
        beyond = f"beyond {-1000.0 * EARLIEST:g} to {1000.0 * LAG:g} ms, which no sensor has"
        return 0.0, f"the reversals fit a lag {beyond}: not corrected, {STATE}"
    bounds = f"{lower:.2f} to {upper:.2f}"
    if upper < 0:
        return 0.0, (
            f"friction leads the motion by {-value:.2f} ms ({-upper:.2f} to {-lower:.2f}): due "
            "to σ₁/σ₀, or a lagging position; the record cannot show which. No lag is "
            f"corrected, {STATE}"
        )
    if lower > 0 and found.value > LEAST_LAG:
        return found.value, (
            f"the pressures lag by {value:.2f} ms ({bounds}), from the reversals; corrected"
        )
    return 0.0, ""


def undone(found: Parameter, left: Parameter | None) -> str:
    """Why a lag correction is undone because another lag remains; else empty."""
    if left is None or left.lower <= 0 <= left.upper:
        return ""
    return (
        f"correcting the pressures by {1000.0 * found.value:.2f} ms leaves a lag of "
        f"{1000.0 * left.value:.2f} ms: the lag fits some other effect, so none is corrected; "
        f"{STATE}"
    )


def unparted(lugre: LuGreFit | str) -> LuGreFit | str:
    """A model with sigma_1 for a record of unknown lag, from which it cannot be separated."""
    if isinstance(lugre, str):
        return lugre
    doubt = "σ₁ is valid if no pressure lags: a lag τ adds σ₀ τ"
    parameters = opened(lugre.parameters, ("bristle_damping",))
    return replace(lugre, parameters=parameters, doubts=(*lugre.doubts, doubt))
