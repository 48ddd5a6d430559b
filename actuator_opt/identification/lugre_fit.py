"""LuGre bristles from reversals: integrated along the record, with the record's filter.

Bristle stiffness and damping, and the lag of the pressures, are fitted to windows about the
reversals, together with the Stribeck parameters from the steady points.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ..base.fitting import NORMAL
from .balance import Sliding
from .conditioning import Motion
from .doubtful import PARTED, agreed, opened, widened
from .lugre_problem import LOGARITHMIC, SYMBOLS, TRAVELS, USUAL, LuGreFit, LugreProblem
from .lugre_windows import Windows, no_windows, windows
from .points import SETTLED, SETTLING, Point
from .stribeck_fit import EXPONENT, OTHER, StribeckFit, held_error

__all__ = [
    "LOGARITHMIC",
    "SYMBOLS",
    "TRAVELS",
    "LuGreFit",
    "fit_lugre",
    "settling_distance",
]

BLUR = 40e-3
"""Longest hidden reversal for which a lag is fitted [s] (a choice: ten usual lags)."""
SURER = 10.0
"""Gain in Akaike information required for a falling over a constant level (a choice: very
strong)."""
SLID = 0.95
"""Share of the level that friction must reach for the level to be identifiable (a choice)."""
FAR = 3.0
"""Stribeck speeds at which at most 5 % of F_S - F_C remain at exponent 1 (a choice)."""


def settling_distance(lugre: LuGreFit | str) -> float:
    """Distance after a reversal from which sliding is steady [m], for known bristles."""
    if isinstance(lugre, str) or not lugre.parameters["bristle_stiffness"].identifiable:
        return SETTLED
    level = max(lugre.values.get("static", 0.0), lugre.values["coulomb"])
    return max(SETTLED, SETTLING * level / lugre.values["bristle_stiffness"])


def fit_lugre(
    slidings: Sequence[Sliding],
    motion: Motion,
    points: Sequence[Point],
    stribeck: StribeckFit | str,
    *,
    lag_known: bool,
    settling: float = SETTLED,
) -> LuGreFit | str:
    """The LuGre model of a record, or the reason for none.

    Least squares over points of steady sliding and windows about reversals, each weighted by its
    own scatter [AaltoThesis] eq. 27-31. Without a Stribeck curve, as in pre-sliding, the windows
    alone give F_C and the bristles. In stuck contact sigma_0 z + sigma_1 dz/dt is sigma_0 z
    advanced by sigma_1/sigma_0, like early pressures, so only one of the two is fitted.

    Parameters
    ----------
    slidings, motion : friction along the record, and its filter
    points : of steady sliding
    stribeck : the curve through them, the start of the search
    lag_known : fit sigma_1; else fit the lag of the pressures, with sigma_1 fixed at 0
    settling : distance after a reversal from which sliding is steady [m]

    Returns
    -------
    the fit, or the reason for none
    """
    curve_known = stribeck if isinstance(stribeck, StribeckFit) else None
    reference = 0.0 if curve_known is None else curve_known.reference_pressure
    slowest = np.inf if curve_known is None else min(one.speed for one in points)
    found = windows(slidings, motion, reference, slowest, settling)
    if found is None:
        return no_windows(motion)
    seen = found.blur < BLUR
    if curve_known is None:
        fit = _level(found, lag_known, seen)
    else:
        problem = LugreProblem(found, points, curve_known, lag_known, seen)
        fit = problem.solve()
        if "stribeck_speed" in fit.parameters and not np.isfinite(fit.parameters["coulomb"].upper):
            fit = _parted(fit, points, curve_known, found, lag_known, seen)
        fit = _as_the_points(fit, curve_known, points)
    if lag_known or seen:
        return fit
    doubt = (
        f"the position resolution hides reversals for {1000.0 * found.blur:.0f} ms: no lag of "
        f"the pressures is fitted, but bounds allow for {1000.0 * USUAL:.0f} ms; move faster or "
        "state --pressure-lag"
    )
    return replace(fit, doubts=(*fit.doubts, doubt))


def _level(found: Windows, lag_known: bool, lag_seen: bool) -> LuGreFit:
    """The model from windows alone: a constant friction level, or one that falls from F_S."""
    fit = LugreProblem(found, (), None, lag_known, lag_seen).solve()
    slid = fit.misfit + found.largest > SLID * fit.values["coulomb"]
    if slid:
        falling = _falling(found, lag_known, lag_seen, EXPONENT)
        count = 2 * float(found.judged.sum())
        better = count * np.log(fit.misfit / falling.misfit)
        more = 2 * (len(falling.parameters) - len(fit.parameters))
        if better > more + SURER:
            free = _falling(found, lag_known, lag_seen)
            known = free.parameters["exponent"].identifiable
            fit = free if known else _any_exponent(falling, found, lag_known, lag_seen)
    fastest = 1e3 * found.fastest
    if "static" in fit.parameters:
        if found.fastest < FAR * fit.values["stribeck_speed"]:
            fit = replace(fit, parameters=opened(fit.parameters, PARTED))
        doubt = (
            f"F_C is the level at {fastest:.3g} mm/s, including viscous friction, as one speed "
            "cannot separate them; give plateaus or sweeps of other speeds"
        )
    elif slid:
        doubt = (
            f"F_C is the friction level up to {fastest:.3g} mm/s, between F_C and F_S: give "
            "plateaus or sweeps of other speeds"
        )
    else:
        doubt = "the rod hardly slides: the record shows bristles, but no friction level"
        fit = replace(fit, parameters=opened(fit.parameters, ("coulomb",)))
    return replace(fit, doubts=(*fit.doubts, doubt))


def _falling(
    found: Windows, lag_known: bool, lag_seen: bool, exponent: float | None = None
) -> LuGreFit:
    """The model from windows alone with a falling level, with a fixed exponent if given."""
    held = None if exponent is None else {"exponent": exponent}
    return LugreProblem(found, (), None, lag_known, lag_seen, falling=True, held=held).solve()


def _any_exponent(fit: LuGreFit, found: Windows, lag_known: bool, lag_seen: bool) -> LuGreFit:
    """A falling level with bounds that allow for exponents other than the fixed one.

    Each parameter has the larger uncertainty of both fits, plus their difference.
    """
    other = _falling(found, lag_known, lag_seen, OTHER)
    more = held_error(fit.parameters, other.values)
    for name, extra in more.items():
        apart = [one.parameters[name].standard_error ** 2 for one in (fit, other)]
        if np.isfinite(apart).all():
            more[name] = float(np.sqrt(extra**2 + max(apart[1] - apart[0], 0.0)))
    doubt = f"the exponent is fixed at {EXPONENT:g}, bounds allow for {OTHER:g}"
    parameters = widened(fit.parameters, more, NORMAL)
    return replace(fit, parameters=parameters, doubts=(*fit.doubts, doubt))


def _as_the_points(fit: LuGreFit, stribeck: StribeckFit, points: Sequence[Point]) -> LuGreFit:
    """The model without parameters that the points of steady sliding rule out."""
    level, speed = stribeck.parameters["coulomb"], fit.parameters.get("stribeck_speed")
    doubts = list(fit.doubts)
    parameters = dict(fit.parameters)
    if stribeck.doubted:
        told = agreed(parameters, stribeck.parameters)
        parameters = opened(parameters, set(parameters) - set(told))
        doubts.append("areas or sensors are wrong, according to the points of steady sliding")
    elif not np.isfinite(level.upper) and not (speed is not None and speed.identifiable):
        if np.isfinite(parameters["coulomb"].upper):
            fastest = 1e3 * max(one.speed for one in points)
            doubts.append(
                f"F_C is the friction level up to {fastest:.3g} mm/s: steady sliding there does "
                "not separate it from F_S and σ₂; give more and faster speeds"
            )
        parameters = opened(parameters, PARTED)
    return replace(fit, parameters=parameters, doubts=tuple(doubts))


def _parted(
    fit: LuGreFit,
    points: Sequence[Point],
    stribeck: StribeckFit,
    found: Windows,
    lag_known: bool,
    lag_seen: bool,
) -> LuGreFit:
    """F_S and sigma_0, with the change due to fixing F_C and sigma_2 if those are not separated."""
    held = {"viscous": 0.0, "exponent": EXPONENT}
    other = LugreProblem(found, points, stribeck, lag_known, lag_seen, held=held).solve()
    more = {
        name: abs(other.values[name] - fit.values[name])
        for name in ("static", "bristle_stiffness")
        if name in fit.parameters
    }
    return replace(fit, parameters=widened(fit.parameters, more, NORMAL))
