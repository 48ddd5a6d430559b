"""Bounds by resampling instead of the linearised model: a wild bootstrap of points and windows.

Points of steady sliding are few, and a single one often determines a parameter (the slowest F_S,
the fastest sigma_2). Drawing points with replacement would lose it, so their residuals are drawn
instead [Wu1986]. Each has the variance implied by itself and its own error: for independent noise
of unit weight, E[noise_i^2 | residuals] = r_i^2 + h_i s^2, h_i the leverage, s^2 the sum of squares
over n - p [derived]. Where the fit bends to a point, its own error counts; else its residual.
Windows about reversals are blocks, as their samples are correlated: all residuals of one are drawn
together. To first order this is the bootstrap of whole windows, but every draw keeps both
directions and the sharpest reversals.

Each draw also scales the noise by sqrt(nu/chi^2_nu), as its size is known from only nu spare points
or windows; for a linear model the bounds are then Student's t. Every draw is fitted again from the
optimum, F_S and v_s from three starts, by damped Gauss-Newton steps within the search limits.
Bounds are percentiles: they respect the limits, follow skewed parameters, and do not depend on the
parametrisation. The acceleration of BCa needs fits without one point at a time, which do not exist
where that point alone determines a parameter.

The selection of parameters is not repeated: the bounds apply to those already selected.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from ..base.errors import Diagnostic, InputError
from ..base.fitting import CONFIDENCE, WEAK, FitSearch, Parameter, quantile, relaxed
from ..base.numeric import STEP as COMPLEX_STEP, Array
from .balance import Sliding
from .conditioning import ConditionedRecord
from .lugre import (
    BENDS,
    LAG,
    LOGARITHMIC,
    STEP,
    SYMBOLS,
    TRAVELS,
    LuGreFit,
    Windows,
    sizes,
    windows,
)
from .points import SETTLED, FrictionPoint
from .stribeck_fit import EXPONENTS, SPEEDS, STATIC_MOST, Steady, StribeckFit

FEWEST = 80
"""Least number of resamples, so that the bound is the second from each end, not the outermost."""
STARTS = (1.0, 1 / 3, 3.0)
"""Initial Stribeck speeds of a refit relative to the optimum (a choice: half a decade either
way)."""
STEPS, LUGRE_STEPS = 40, 8
"""Steps of a fit, and of one with the slopes of the optimum (a choice: the bounds of the synthetic
records do not change beyond)."""
LEAST_WINDOWS = 3
"""Least number of windows to draw from (a choice: with two the noise follows from one
difference)."""
ROWS = 256
"""Draws integrated at once (a choice: some 100 MB)."""
RANK = 1e-10
"""Least ratio of singular values of slopes for the leverage: rounding lies below."""
LOGS = ("stribeck_speed", "bristle_stiffness")
"""Searched by logarithm; sigma_1, which may be 0, is not."""
PHYSICAL = ("static", "viscous", "bristle_damping")
"""Parameters with a physical lower limit: F_C for F_S, else 0."""
SIGNED = ("offset", "pressure_slope", "lag")
"""Parameters that may be 0: bounds that include 0 do not mean they are unknown."""
AT_END = 1e-6
"""Relative distance from a search limit that counts as reached."""


def resampled(
    slidings: Sequence[Sliding],
    motion: ConditionedRecord,
    points: Sequence[FrictionPoint],
    stribeck: StribeckFit | str,
    lugre: LuGreFit | str,
    *,
    count: int,
    seed: int,
    settling: float = SETTLED,
) -> tuple[StribeckFit | str, LuGreFit | str]:
    """Both models of a record with bounds by resampling.

    Values stay; bounds, standard errors (half the bounds over Student's t) and verdicts change. A
    parameter left open by the linearised model stays open, and so does one whose draws reach a
    search limit. A parameter that is not identifiable keeps the wider of both bounds: its optimum
    lies in a flat valley, and draws show the scatter about it, not the valley. The same applies to
    LuGre if F_C is open or no lag is fitted, as its bounds then contain more than scatter. The
    Stribeck curve's covariance stays that of the linearised model.

    Parameters
    ----------
    slidings, motion, points : data of both fits
    stribeck, lugre : the fits, or the reason for a missing fit
    count : of resamples
    seed : of the draws; the same seed gives the same bounds
    settling : distance after a reversal from which sliding is steady [m], as in the fits

    Returns
    -------
    the fits with new bounds

    Raises
    ------
    InputError
        too few resamples
    """
    if count < FEWEST:
        message = f"{count} resamples are too few for 2.5 % tails"
        raise InputError(Diagnostic(message, f"use {FEWEST} or more, usually 200"))
    first, second = (np.random.default_rng(one) for one in np.random.SeedSequence(seed).spawn(2))
    curve_known = stribeck if isinstance(stribeck, StribeckFit) else None
    if isinstance(lugre, LuGreFit):
        reference = 0.0 if curve_known is None else curve_known.reference_pressure
        slowest = np.inf if curve_known is None else min(point.speed for point in points)
        found = windows(slidings, motion, reference, slowest, settling)
        if found is not None:
            lugre = _lugre(found, points, curve_known, lugre, count, second)
    if curve_known is not None:
        stribeck = resampled_stribeck(points, curve_known, count=count, rng=first)
    return stribeck, lugre


def resampled_stribeck(
    points: Sequence[FrictionPoint], fit: StribeckFit, *, count: int, rng: np.random.Generator
) -> StribeckFit:
    """A Stribeck curve with bounds by resampling its points."""
    names = tuple(fit.parameters)
    spare = len(points) - len(names)
    if spare < 1:
        return fit
    errors, values = fit.errors, fit.values
    steady = Steady(points, errors)
    search = _search(names, values, steady.largest, {"coulomb": (1e-6 * steady.largest, np.inf)})

    def model(rows: Array) -> Array:
        own = {name: x[:, None] for name, x in natural(names, rows, values).items()}
        return steady.predict(own) / errors

    def slopes(rows: Array) -> Array:
        steps = 1j * COMPLEX_STEP * np.eye(rows.shape[1])
        return np.stack([np.imag(model(rows + step)) / COMPLEX_STEP for step in steps], axis=-1)

    best = searched(names, values)[None]
    rest = fit.residuals / errors
    spread = _spreads(slopes(best)[0], rest, float(np.sum(rest**2)) / spare)
    noise = spread * rng.standard_normal((count, spread.size)) * _scales(rng, spare, count)
    starts = STARTS if "stribeck_speed" in names else STARTS[:1]
    target = np.tile(model(best) + noise, (len(starts), 1))
    rows = np.repeat(best, target.shape[0], axis=0)
    if "stribeck_speed" in names:
        rows[:, names.index("stribeck_speed")] += np.repeat(np.log(starts), count)
    found, cost = relaxed(lambda x, at: model(x) - target[at], slopes, rows, search, STEPS)
    least = np.argmin(cost.reshape(-1, count), axis=0)
    found = found.reshape(-1, count, best.size)[least, np.arange(count)]
    return replace(fit, parameters=_bounded(fit.parameters, search, found, values, spare))


def _lugre(
    found: Windows,
    points: Sequence[FrictionPoint],
    stribeck: StribeckFit | None,
    fit: LuGreFit,
    count: int,
    rng: np.random.Generator,
) -> LuGreFit:
    """A LuGre model with bounds by resampling points and windows."""
    blocks = found.velocity.shape[0]
    if blocks < LEAST_WINDOWS:
        doubt = f"{blocks} windows are too few to resample: bounds are from the linearised model"
        return replace(fit, doubts=(*fit.doubts, doubt))
    problem = LuGreResiduals(found, points, stribeck, fit)
    best = searched(tuple(fit.parameters), fit.values)
    rest = problem.misfit(best[None])[0]
    jacobian = problem.slopes(best)
    steady = rest.size - blocks * found.kept.size
    spare = max(steady - (0 if stribeck is None else len(stribeck.parameters)), 1)
    variance = float(np.sum(rest[:steady] ** 2)) / spare
    spread = _spreads(jacobian, rest, variance)[:steady]
    noise = np.concatenate(
        [
            spread * rng.standard_normal((count, steady)) * _scales(rng, spare, count),
            np.repeat(rng.standard_normal((count, blocks)), found.kept.size, axis=1)
            * rest[steady:]
            * np.sqrt(blocks / (blocks - 1))
            * _scales(rng, blocks - 1, count),
        ],
        axis=1,
    )
    rows = []
    for first in range(0, count, ROWS):
        target = rest + noise[first : first + ROWS]

        def misfit(x: Array, at: Array, target: Array = target) -> Array:
            return problem.misfit(x) - target[at]

        begin = np.repeat(best[None], target.shape[0], axis=0)
        rows.append(
            relaxed(misfit, lambda _: jacobian[None], begin, problem.search, LUGRE_STEPS)[0]
        )
    unseen = {"lag", "bristle_damping"} <= set(fit.held)
    open_level = not np.isfinite(fit.parameters["coulomb"].upper)
    wider = tuple(fit.parameters) if unseen or open_level else tuple(SYMBOLS)
    parameters = _bounded(
        fit.parameters, problem.search, np.concatenate(rows), fit.values, blocks - 1, wider
    )
    was = {f"{SYMBOLS[n]} is {fit.parameters[n].verdict}" for n in _bristles(fit.parameters)}
    doubts = [doubt for doubt in fit.doubts if doubt not in was]
    doubts += [
        f"{SYMBOLS[name]} is {parameters[name].verdict}"
        for name in _bristles(parameters)
        if not parameters[name].identifiable
    ]
    return replace(fit, parameters=parameters, doubts=tuple(doubts))


def _bristles(parameters: Mapping[str, Parameter]) -> list[str]:
    return [name for name in LOGARITHMIC[:2] if name in parameters]


class LuGreResiduals:
    """Weighted residuals of points and windows as functions of the searched numbers."""

    def __init__(
        self,
        found: Windows,
        points: Sequence[FrictionPoint],
        stribeck: StribeckFit | None,
        fit: LuGreFit,
    ) -> None:
        self.names, self.values = tuple(fit.parameters), fit.values
        best = searched(self.names, self.values)
        level = min(max(self.values["static"], self.values["coulomb"]), found.largest)
        travel = BENDS * level / self.values["bristle_stiffness"]
        chosen = found.chosen(natural(self.names, best[None], self.values))
        self.windows = chosen.resolved(travel)
        self.spread, self.largest, self.steady = fit.misfit, found.largest, None
        if stribeck is not None:
            self.steady = Steady(points, stribeck.errors * stribeck.scatter)
        soft, stiff = (np.log(self.largest / one) for one in reversed(TRAVELS))
        ends = {
            "coulomb": (1e-3 * self.largest, np.inf),
            "bristle_stiffness": (soft, stiff),
            "lag": (-LAG, LAG),
        }
        self.search = _search(self.names, self.values, self.largest, ends)

    def misfit(self, rows: Array) -> Array:
        """Weighted residuals (rows, residuals)."""
        values = natural(self.names, rows, self.values)
        lanes = (self.windows.misfit(values) / self.spread).reshape(rows.shape[0], -1)
        if self.steady is None:
            return lanes
        steady = {n: x[:, None] for n, x in values.items() if n not in SYMBOLS}
        return np.concatenate([self.steady.residual(steady), lanes], axis=1)

    def slopes(self, best: Array) -> Array:
        """Derivatives at the optimum by central differences (residuals, searched)."""
        steps = STEP * sizes(self.names, self.largest, self.steady)
        if "bristle_damping" in self.names:
            steps[self.names.index("bristle_damping")] *= 1e-2 * self.values["bristle_stiffness"]
        moved = self.misfit(np.concatenate([best + np.diag(steps), best - np.diag(steps)]))
        return ((moved[: best.size] - moved[best.size :]) / (2 * steps[:, None])).T


def _search(
    names: tuple[str, ...],
    values: Mapping[str, float],
    largest: float,
    ends: Mapping[str, tuple[float, float]],
) -> FitSearch:
    """Limits of the search; an optimum on a limit lies within it."""
    usual = {
        "static": (0.0, STATIC_MOST * largest),
        "stribeck_speed": (float(np.log(SPEEDS[0])), float(np.log(SPEEDS[1]))),
        "exponent": EXPONENTS,
        "viscous": (0.0, np.inf),
        "bristle_damping": (0.0, np.inf),
    } | dict(ends)
    best = searched(names, values)
    pairs = [usual.get(name, (-np.inf, np.inf)) for name in names]
    low = np.minimum([pair[0] for pair in pairs], best)
    return FitSearch(names, low, np.maximum([pair[1] for pair in pairs], best))


def searched(names: Sequence[str], values: Mapping[str, float]) -> Array:
    """Searched numbers of parameters: logarithms, and F_S as its excess over F_C."""
    own = dict(values)
    own["static"] = own.get("static", own["coulomb"]) - own["coulomb"]
    return np.array([np.log(own[n]) if n in LOGS else own[n] for n in names])


def natural(names: Sequence[str], rows: Array, values: Mapping[str, float]) -> dict[str, Array]:
    """Parameters (rows,) from searched numbers (rows, searched), the others unchanged."""
    own = {
        name: np.exp(column) if name in LOGS else column
        for name, column in zip(names, rows.T, strict=True)
    }
    found = {name: np.full(rows.shape[0], x) for name, x in values.items()} | own
    if "static" in own:
        found["static"] = found["coulomb"] + own["static"]
    elif "static" not in values or values["static"] == values["coulomb"]:
        found["static"] = found["coulomb"]
    return found


def _spreads(slopes: Array, residuals: Array, variance: float) -> Array:
    """Standard deviation of the noise in each weighted residual, sqrt(r^2 + h s^2)."""
    lengths = np.linalg.norm(slopes, axis=0)
    left, singular, _ = np.linalg.svd(
        slopes / np.where(lengths > 0, lengths, 1.0), full_matrices=False
    )
    leverage = np.sum(left[:, singular > RANK * singular[0]] ** 2, axis=1)
    return np.sqrt(residuals**2 + leverage * variance)


def _scales(rng: np.random.Generator, freedom: int, count: int) -> Array:
    """Noise factor of each draw relative to the residuals (count, 1)."""
    return np.sqrt(freedom / rng.chisquare(freedom, (count, 1)))


def _bounded(
    parameters: Mapping[str, Parameter],
    search: FitSearch,
    found: Array,
    values: Mapping[str, float],
    spare: int,
    wider: Sequence[str] = (),
) -> dict[str, Parameter]:
    """Parameters with percentile bounds; without bounds if draws reach an open search limit.

    Those named in `wider` keep the wider of both bounds.
    """
    count = found.shape[0]
    own = natural(search.names, found, values)
    tail = max(int((count + 1) * (1 - CONFIDENCE) / 2), 1)
    unseen = np.zeros(count, dtype=bool)
    if "static" in search.names:
        unseen = found[:, search.names.index("static")] <= AT_END * values["coulomb"]
    result = dict(parameters)
    for k, name in enumerate(search.names):
        was = parameters[name]
        if not np.isfinite(was.standard_error):
            continue
        value, draws = was.value, own[name].copy()
        near = AT_END * max(abs(found[:, k]).max(), 1e-300)
        if name not in PHYSICAL:
            draws[found[:, k] <= search.low[k] + near] = -np.inf
        draws[found[:, k] >= search.high[k] - near] = np.inf
        if name in ("stribeck_speed", "exponent"):
            draws[unseen] = np.resize([-np.inf, np.inf], int(unseen.sum()))
        draws.sort()
        low, high = min(draws[tail - 1], value), max(draws[count - tail], value)
        if name in wider or (name not in SIGNED and was.verdict == "not identifiable"):
            low, high = min(low, was.lower), max(high, was.upper)
        with np.errstate(invalid="ignore"):
            error = (high - low) / (2 * quantile(spare))
        sure = max(high - value, value - low) <= WEAK * abs(value)
        result[name] = Parameter(value, float(low), float(high), float(error), bool(sure))
    return result
