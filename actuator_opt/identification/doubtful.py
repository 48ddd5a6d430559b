"""What a record cannot tell, whatever its scatter: bounds beyond those of the linearised model."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

import numpy as np

from ..least_squares import WEAK, Parameter

REACH = 1.5
"""Stribeck speeds that a record must reach for F_C and sigma_2 to part: there the Stribeck part is
e^(-1.5^2) = 0.1 of its height at exponent 2 (a choice)."""
PARTED = ("coulomb", "viscous", "stribeck_speed", "exponent")


def opened(parameters: Mapping[str, Parameter], names: Iterable[str]) -> dict[str, Parameter]:
    """Parameters of which those named are not known at all."""
    found = dict(parameters)
    for name in names:
        if name in found:
            found[name] = Parameter(found[name].value, -np.inf, np.inf, np.inf, False)
    return found


def widened(
    parameters: Mapping[str, Parameter], more: Mapping[str, float], quantile: float
) -> dict[str, Parameter]:
    """Parameters with a standard error more, independent of theirs."""
    found = dict(parameters)
    for name, extra in more.items():
        one = found[name]
        error = float(np.hypot(one.standard_error, extra))
        half = quantile * error
        near = one.identifiable and (extra == 0 or half <= WEAK * abs(one.value))
        found[name] = Parameter(one.value, one.value - half, one.value + half, error, bool(near))
    return found


def hidden(parameters: Mapping[str, Parameter], fastest: float, falls: bool) -> str | None:
    """Why F_C and sigma_2 cannot be parted, if they cannot.

    Parameters
    ----------
    parameters : of a Stribeck curve, or of LuGre
    fastest : speed of the record [m/s]
    falls : whether friction at the fastest speed is below that at slower ones

    Returns
    -------
    one line; None where they can
    """
    speed = parameters.get("stribeck_speed")
    if speed is None:
        if falls and "viscous" in parameters:
            return (
                f"friction falls up to {1e3 * fastest:.3g} mm/s and its rise towards rest is not "
                "resolved: F_C and σ₂ are not known; give more speeds, and faster ones"
            )
        return None
    if fastest < REACH * speed.value:
        return (
            f"the record ends at {1e3 * fastest:.3g} mm/s, within the Stribeck rise (v_s "
            f"{1e3 * speed.value:.3g} mm/s): F_C, σ₂ and v_s are not parted; move faster"
        )
    return None
