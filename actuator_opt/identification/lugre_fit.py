"""LuGre bristles from reversals: integrated along the record, filtered as the record is.

Stiffness and damping of the bristles, and the time by which the pressures come late, are fitted to
windows about the reversals, together with what the steady points say of the Stribeck curve.
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
"""Time by which a turn may be hidden for a lag to be looked for [s] (a choice: ten usual lags)."""
SURER = 10.0
"""Akaike information by which a falling level must better one level (a choice: very strong)."""
SLID = 0.95
"""Share of the level that friction must reach for the level to be seen (a choice)."""
FAR = 3.0
"""Stribeck speeds at which no more is left of F_S - F_C than 5 % at exponent 1 (a choice)."""


def settling_distance(lugre: LuGreFit | str) -> float:
    """Distance after a reversal from which sliding is steady [m], by bristles that are known."""
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
    """The LuGre model of a record, or why there is none.

    Least squares over points of steady sliding and windows about reversals, each weighted by its
    own scatter [AaltoThesis] eq. 27-31. Without a Stribeck curve, as in pre-sliding, the windows
    alone give F_C and the bristles. In stuck contact sigma_0 z + sigma_1 dz/dt is sigma_0 z a time
    sigma_1/sigma_0 earlier, as if the pressures came that much sooner: one of the two is asked for.

    Parameters
    ----------
    slidings, motion : friction along the record, and how it was filtered
    points : of steady sliding
    stribeck : the curve through them, where the search begins
    lag_known : whether to ask for sigma_1; else for the lag of the pressures, sigma_1 held at 0
    settling : distance after a reversal from which sliding is steady [m]

    Returns
    -------
    the fit, or one line that says what is missing
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
        f"steps of the position sensor hide the turns for {1e3 * found.blur:.0f} ms: no lag of the "
        f"pressures is looked for, bounds allow for {1e3 * USUAL:.0f} ms; move faster or state "
        "--pressure-lag"
    )
    return replace(fit, doubts=(*fit.doubts, doubt))


def _level(found: Windows, lag_known: bool, lag_seen: bool) -> LuGreFit:
    """The model of windows alone: one level of friction, or one that falls from F_S."""
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
            f"F_C is the level at {fastest:.3g} mm/s with what is viscous there: one speed cannot "
            "part them; give plateaus or sweeps of other speeds"
        )
    elif slid:
        doubt = (
            f"F_C is the level of friction up to {fastest:.3g} mm/s, between F_C and F_S: give "
            "plateaus or sweeps of other speeds"
        )
    else:
        doubt = "the rod hardly slides: bristles alone are seen, no level of friction"
        fit = replace(fit, parameters=opened(fit.parameters, ("coulomb",)))
    return replace(fit, doubts=(*fit.doubts, doubt))


def _falling(
    found: Windows, lag_known: bool, lag_seen: bool, exponent: float | None = None
) -> LuGreFit:
    """The model of windows alone with a level that falls, its exponent held where one is given."""
    held = None if exponent is None else {"exponent": exponent}
    return LugreProblem(found, (), None, lag_known, lag_seen, falling=True, held=held).solve()


def _any_exponent(fit: LuGreFit, found: Windows, lag_known: bool, lag_seen: bool) -> LuGreFit:
    """A level that falls, with bounds that allow for another exponent than the one held.

    Each parameter is as uncertain as in the less certain fit, and by the difference of both.
    """
    other = _falling(found, lag_known, lag_seen, OTHER)
    more = held_error(fit.parameters, other.values)
    for name, extra in more.items():
        apart = [one.parameters[name].standard_error ** 2 for one in (fit, other)]
        if np.isfinite(apart).all():
            more[name] = float(np.sqrt(extra**2 + max(apart[1] - apart[0], 0.0)))
    doubt = f"the exponent is held at {EXPONENT:g}, bounds allow for {OTHER:g}"
    parameters = widened(fit.parameters, more, NORMAL)
    return replace(fit, parameters=parameters, doubts=(*fit.doubts, doubt))


def _as_the_points(fit: LuGreFit, stribeck: StribeckFit, points: Sequence[Point]) -> LuGreFit:
    """The model without what the points of steady sliding deny it."""
    level, speed = stribeck.parameters["coulomb"], fit.parameters.get("stribeck_speed")
    doubts = list(fit.doubts)
    parameters = dict(fit.parameters)
    if stribeck.doubted:
        told = agreed(parameters, stribeck.parameters)
        parameters = opened(parameters, set(parameters) - set(told))
        doubts.append("areas or sensors are wrong, by the points of steady sliding")
    elif not np.isfinite(level.upper) and not (speed is not None and speed.identifiable):
        if np.isfinite(parameters["coulomb"].upper):
            fastest = 1e3 * max(one.speed for one in points)
            doubts.append(
                f"F_C is the level of friction up to {fastest:.3g} mm/s: steady sliding there does "
                "not part it from F_S and σ₂; give more speeds, and faster ones"
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
    """F_S and sigma_0 with what they move by if F_C and sigma_2, not parted, are held."""
    held = {"viscous": 0.0, "exponent": EXPONENT}
    other = LugreProblem(found, points, stribeck, lag_known, lag_seen, held=held).solve()
    more = {
        name: abs(other.values[name] - fit.values[name])
        for name in ("static", "bristle_stiffness")
        if name in fit.parameters
    }
    return replace(fit, parameters=widened(fit.parameters, more, NORMAL))
