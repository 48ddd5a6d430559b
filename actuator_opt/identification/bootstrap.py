"""Confidence intervals by resampling (a wild bootstrap), instead of from the linearised model.

There are few points of steady sliding, and often a single point determines a parameter: the slowest
point determines the static friction F_S, the fastest the viscous friction sigma_2. Drawing points
with replacement would lose such a point. Therefore every draw keeps all points and gives them new
random noise [Wu1986], whose size follows from their residuals. The variance of the noise of point i
is r_i^2 + h_i s^2, with its residual r_i, its leverage h_i, and s^2, the sum of squares divided by
the number of points less that of parameters [derived for independent noise of unit weight]. Where
the fit follows a point closely, the term with s^2 dominates, elsewhere the residual. The samples of
a time window around a reversal are correlated, so all residuals of a window are multiplied by the
same random number. To first order this equals drawing whole windows with replacement, but every
draw contains both directions and the sharpest reversals.

Each draw also scales the noise by sqrt(nu/chi^2_nu), because only nu degrees of freedom determine
its size. For a linear model, the intervals are then those of Student's t. A new fit is made to
every draw, within the search limits, by damped Gauss-Newton steps that start from the optimum. For
a Stribeck curve, they also start from two other values of the Stribeck speed v_s. The confidence
limits are percentiles of these fits. Percentiles respect the search limits, follow skewed
distributions, and do not depend on the parametrisation. The BCa method would need fits that leave
out one point at a time. Such a fit does not exist if that point alone determines a parameter.

The selection of fitted parameters is not repeated for each draw. The intervals are thus valid for
the parameters already selected.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from ..base.errors import Diagnostic, InputError
from ..base.fitting import CONFIDENCE, FitSearch, Parameter, quantile, rated, relaxed
from ..base.numeric import STEP as COMPLEX_STEP, Array
from .balance import Sliding
from .conditioning import ConditionedRecord
from .lugre import BENDS, LOGARITHMIC, STEP, SYMBOLS, TRAVELS, LuGreFit, sizes
from .points import SETTLED, FrictionPoint
from .stribeck_fit import EXPONENTS, SPEEDS, STATIC_MOST, Steady, StribeckFit
from .windows import LAG, Windows, windows

FEWEST = 80
"""Smallest number of resamples. With it, the confidence limits are the second smallest and second
largest values, not the extremes."""
STARTS = (1.0, 1 / 3, 3.0)
"""Stribeck speeds from which a new fit starts, divided by the fitted speed v_s of the record (our
choice: half a decade to either side)."""
STEPS, LUGRE_STEPS = 40, 8
"""Number of Gauss-Newton steps for each draw, for a Stribeck fit and for a LuGre fit. The LuGre fit
uses the derivatives at the optimum in every step (our choice: more steps do not change the
confidence limits for synthetic records)."""
LEAST_WINDOWS = 3
"""Smallest number of windows to draw from (our choice: with two windows, a single difference would
determine the noise)."""
ROWS = 256
"""Number of draws for which the LuGre model is integrated at once (our choice: needs some 100
MB)."""
RANK = 1e-10
"""Singular values of the residuals' derivatives below this share of the largest one are taken as
rounding errors and do not enter the leverage."""
LOGS = ("stribeck_speed", "bristle_stiffness")
"""Parameters whose logarithms are searched. The bristle damping sigma_1 itself is searched, because
it may be 0."""
PHYSICAL = ("static", "viscous", "bristle_damping")
"""Parameters with a physical lower limit: Coulomb friction F_C for the static friction F_S, 0 for
the other two."""
SIGNED = ("offset", "pressure_slope", "lag")
"""Parameters that may be 0. If their interval contains 0, they still count as known."""
AT_END = 1e-6
"""A draw counts as having reached a search limit if it is closer to the limit than this share of
the largest value among all draws."""


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
    """Both friction models of a record, with confidence intervals by resampling.

    The fitted values stay as they are. Confidence limits, standard errors (half the interval,
    divided by Student's t) and verdicts are new. A parameter without confidence limits in the
    linearised model gets none here either. A parameter whose draws reach a search limit loses its
    confidence limits.

    A parameter that is not identifiable gets the wider of its linearised and its resampled
    interval: its optimum lies in a flat valley, and the draws show the scatter around the optimum,
    not the length of the valley. The bristle parameters and the lag always get the wider interval.
    So do all parameters of the LuGre model if F_C has no confidence limits, or if neither lag nor
    bristle damping is fitted, because the linearised intervals then allow for more than
    scatter, such as a lag that was not fitted.
    The covariance of the Stribeck curve stays that of the linearised model.

    Parameters
    ----------
    slidings, motion, points : data to which both models are fitted
    stribeck, lugre : the fits, or the reason why a fit is missing
    count : number of resamples
    seed : seed of the random draws; the same seed gives the same result
    settling : distance after a reversal beyond which sliding is steady [m], as in the fits

    Returns
    -------
    the fits with new confidence intervals

    Raises
    ------
    InputError
        too few resamples
    """
    if count < FEWEST:
        message = f"{count} resamples are too few to find the outer 2.5 % on each side"
        raise InputError(Diagnostic(message, f"use {FEWEST} or more, usually 200"))
    curve_rng, window_rng = map(np.random.default_rng, np.random.SeedSequence(seed).spawn(2))
    curve = stribeck if isinstance(stribeck, StribeckFit) else None
    if isinstance(lugre, LuGreFit):
        reference = 0.0 if curve is None else curve.reference_pressure
        slowest = np.inf if curve is None else min(point.speed for point in points)
        reversals = windows(slidings, motion, reference, slowest, settling)
        if reversals is not None:
            lugre = _lugre(reversals, points, curve, lugre, count, window_rng)
    if curve is not None:
        stribeck = resampled_stribeck(points, curve, count=count, rng=curve_rng)
    return stribeck, lugre


def resampled_stribeck(
    points: Sequence[FrictionPoint], fit: StribeckFit, *, count: int, rng: np.random.Generator
) -> StribeckFit:
    """A Stribeck curve with confidence intervals from resampled points."""
    names = tuple(fit.parameters)
    spare = len(points) - len(names)
    if spare < 1:
        return fit
    errors, values = fit.errors, fit.values
    steady = Steady(points, errors)
    search = _search(names, values, steady.largest, {"coulomb": (1e-6 * steady.largest, np.inf)})

    def model(rows: Array) -> Array:
        parameters = {name: x[:, None] for name, x in natural(names, rows, values).items()}
        return steady.predict(parameters) / errors

    def slopes(rows: Array) -> Array:
        steps = 1j * COMPLEX_STEP * np.eye(rows.shape[1])
        return np.stack([np.imag(model(rows + step)) / COMPLEX_STEP for step in steps], axis=-1)

    best = searched(names, values)[None]
    residuals = fit.residuals / errors
    spread = _spreads(slopes(best)[0], residuals, float(np.sum(residuals**2)) / spare)
    noise = spread * rng.standard_normal((count, spread.size)) * _scales(rng, spare, count)
    starts = STARTS if "stribeck_speed" in names else STARTS[:1]
    target = np.tile(model(best) + noise, (len(starts), 1))
    rows = np.repeat(best, target.shape[0], axis=0)
    if "stribeck_speed" in names:
        rows[:, names.index("stribeck_speed")] += np.repeat(np.log(starts), count)
    optima, cost = relaxed(lambda x, at: model(x) - target[at], slopes, rows, search, STEPS)
    best_start = np.argmin(cost.reshape(-1, count), axis=0)
    optima = optima.reshape(-1, count, best.size)[best_start, np.arange(count)]
    return replace(fit, parameters=_bounded(fit.parameters, search, optima, values, spare))


def _lugre(
    reversals: Windows,
    points: Sequence[FrictionPoint],
    stribeck: StribeckFit | None,
    fit: LuGreFit,
    count: int,
    rng: np.random.Generator,
) -> LuGreFit:
    """A LuGre model with confidence intervals from resampled points and windows."""
    blocks = reversals.velocity.shape[0]
    if blocks < LEAST_WINDOWS:
        doubt = (
            f"{blocks} time windows are too few to resample, so the confidence intervals "
            "come from the linearised model"
        )
        return replace(fit, doubts=(*fit.doubts, doubt))
    problem = LuGreResiduals(reversals, points, stribeck, fit)
    best = searched(tuple(fit.parameters), fit.values)
    residuals = problem.misfit(best[None])[0]
    jacobian = problem.slopes(best)
    fitted = 0 if stribeck is None else len(stribeck.parameters)
    noise = _lugre_noise(rng, residuals, jacobian, blocks, reversals.kept.size, fitted, count)
    rows = []
    for first in range(0, count, ROWS):
        target = residuals + noise[first : first + ROWS]

        def misfit(x: Array, at: Array, target: Array = target) -> Array:
            return problem.misfit(x) - target[at]

        starts = np.repeat(best[None], target.shape[0], axis=0)
        optima, _ = relaxed(misfit, lambda _: jacobian[None], starts, problem.search, LUGRE_STEPS)
        rows.append(optima)
    no_lag = {"lag", "bristle_damping"} <= set(fit.held)
    open_level = not np.isfinite(fit.parameters["coulomb"].upper)
    wider = tuple(fit.parameters) if no_lag or open_level else tuple(SYMBOLS)
    parameters = _bounded(
        fit.parameters,
        problem.search,
        np.concatenate(rows),
        fit.values,
        blocks - 1,
        wider,
    )
    old_verdicts = _bristle_verdicts(fit.parameters)
    doubts = [doubt for doubt in fit.doubts if doubt not in old_verdicts.values()]
    doubts += [
        verdict
        for name, verdict in _bristle_verdicts(parameters).items()
        if not parameters[name].identifiable
    ]
    return replace(fit, parameters=parameters, doubts=tuple(doubts))


def _lugre_noise(
    rng: np.random.Generator,
    residuals: Array,
    jacobian: Array,
    blocks: int,
    block: int,
    fitted: int,
    count: int,
) -> Array:
    """Random changes of the residuals, count x residuals.

    The residuals of steady sliding vary independently, those of a window all with the same factor.

    Parameters
    ----------
    residuals, jacobian : of the best fit; the last `blocks` x `block` residuals are of the windows
    fitted : number of parameters that the steady points determine
    count : number of samples
    """
    steady = residuals.size - blocks * block
    spare = max(steady - fitted, 1)
    variance = float(np.sum(residuals[:steady] ** 2)) / spare
    spread = _spreads(jacobian, residuals, variance)[:steady]
    return np.concatenate(
        [
            spread * rng.standard_normal((count, steady)) * _scales(rng, spare, count),
            np.repeat(rng.standard_normal((count, blocks)), block, axis=1)
            * residuals[steady:]
            * np.sqrt(blocks / (blocks - 1))
            * _scales(rng, blocks - 1, count),
        ],
        axis=1,
    )


def _bristle_verdicts(parameters: Mapping[str, Parameter]) -> dict[str, str]:
    """Verdict on each fitted bristle parameter, in words."""
    return {
        name: f"{SYMBOLS[name]} is {parameters[name].verdict}"
        for name in LOGARITHMIC[:2]
        if name in parameters
    }


class LuGreResiduals:
    """Weighted residuals of the points of steady sliding and of the windows around reversals.

    They are functions of the searched values, which are the fitted parameters or their logarithms.
    """

    def __init__(
        self,
        reversals: Windows,
        points: Sequence[FrictionPoint],
        stribeck: StribeckFit | None,
        fit: LuGreFit,
    ) -> None:
        self.names, self.values = tuple(fit.parameters), fit.values
        best = searched(self.names, self.values)
        level = min(max(self.values["static"], self.values["coulomb"]), reversals.largest)
        travel = BENDS * level / self.values["bristle_stiffness"]
        parameters = natural(self.names, best[None], self.values)
        self.windows = reversals.chosen(parameters).resolved(travel)
        self.spread, self.largest, self.steady = fit.misfit, reversals.largest, None
        if stribeck is not None:
            self.steady = Steady(points, stribeck.errors * stribeck.scatter)
        soft, stiff = (np.log(self.largest / deflection) for deflection in reversed(TRAVELS))
        ends = {
            "coulomb": (1e-3 * self.largest, np.inf),
            "bristle_stiffness": (soft, stiff),
            "lag": (-LAG, LAG),
        }
        self.search = _search(self.names, self.values, self.largest, ends)

    def misfit(self, rows: Array) -> Array:
        """Weighted residuals for every row of searched values, (rows, residuals)."""
        values = natural(self.names, rows, self.values)
        misfits = (self.windows.misfit(values) / self.spread).reshape(rows.shape[0], -1)
        if self.steady is None:
            return misfits
        steady = {n: x[:, None] for n, x in values.items() if n not in SYMBOLS}
        return np.concatenate([self.steady.residual(steady), misfits], axis=1)

    def slopes(self, best: Array) -> Array:
        """Derivatives of the residuals at the optimum, of shape (residuals, searched values)."""
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
    """Limits of the search, moved outwards if the optimum lies outside them."""
    limits = {
        "static": (0.0, STATIC_MOST * largest),
        "stribeck_speed": (float(np.log(SPEEDS[0])), float(np.log(SPEEDS[1]))),
        "exponent": EXPONENTS,
        "viscous": (0.0, np.inf),
        "bristle_damping": (0.0, np.inf),
    } | dict(ends)
    best = searched(names, values)
    pairs = [limits.get(name, (-np.inf, np.inf)) for name in names]
    low = np.minimum([pair[0] for pair in pairs], best)
    return FitSearch(names, low, np.maximum([pair[1] for pair in pairs], best))


def searched(names: Sequence[str], values: Mapping[str, float]) -> Array:
    """The values that the search varies.

    They are the logarithms of the parameters in `LOGS`, F_S - F_C in place of the static friction
    F_S (with Coulomb friction F_C), and the other parameters unchanged.
    """
    numbers = dict(values)
    numbers["static"] = numbers.get("static", numbers["coulomb"]) - numbers["coulomb"]
    return np.array([np.log(numbers[n]) if n in LOGS else numbers[n] for n in names])


def natural(names: Sequence[str], rows: Array, values: Mapping[str, float]) -> dict[str, Array]:
    """Convert searched values, (draws, searched values), to parameters, each of shape (draws,).

    Parameters that are not searched are added with their entry in `values`.
    """
    searched_values = {
        name: np.exp(column) if name in LOGS else column
        for name, column in zip(names, rows.T, strict=True)
    }
    parameters = {name: np.full(rows.shape[0], x) for name, x in values.items()} | searched_values
    if "static" in searched_values:
        parameters["static"] = parameters["coulomb"] + searched_values["static"]
    elif "static" not in values or values["static"] == values["coulomb"]:
        parameters["static"] = parameters["coulomb"]
    return parameters


def _spreads(slopes: Array, residuals: Array, variance: float) -> Array:
    """Standard deviation of the noise in each weighted residual: sqrt(r^2 + h s^2).

    r is the residual, h its leverage, s^2 the variance of the fit.
    """
    lengths = np.linalg.norm(slopes, axis=0)
    left, singular, _ = np.linalg.svd(
        slopes / np.where(lengths > 0, lengths, 1.0), full_matrices=False
    )
    leverage = np.sum(left[:, singular > RANK * singular[0]] ** 2, axis=1)
    return np.sqrt(residuals**2 + leverage * variance)


def _scales(rng: np.random.Generator, freedom: int, count: int) -> Array:
    """Random factors sqrt(nu/chi^2_nu) that scale the noise of each draw, of shape (count, 1)."""
    return np.sqrt(freedom / rng.chisquare(freedom, (count, 1)))


def _bounded(
    parameters: Mapping[str, Parameter],
    search: FitSearch,
    rows: Array,
    values: Mapping[str, float],
    spare: int,
    wider: Sequence[str] = (),
) -> dict[str, Parameter]:
    """Parameters with percentiles of the draws as confidence limits.

    The limits are infinite if draws reach a search limit that has no physical meaning.

    Parameters named in `wider` get the wider of their previous and their new interval. `spare` is
    the number of degrees of freedom, from which standard errors follow.
    """
    count = rows.shape[0]
    samples = natural(search.names, rows, values)
    tail = max(int((count + 1) * (1 - CONFIDENCE) / 2), 1)
    without_rise = np.zeros(count, dtype=bool)
    if "static" in search.names:
        without_rise = rows[:, search.names.index("static")] <= AT_END * values["coulomb"]
    result = dict(parameters)
    for k, name in enumerate(search.names):
        parameter = parameters[name]
        if not np.isfinite(parameter.standard_error):
            continue
        value, draws = parameter.value, samples[name].copy()
        tolerance = AT_END * max(abs(rows[:, k]).max(), 1e-300)
        if name not in PHYSICAL:
            draws[rows[:, k] <= search.low[k] + tolerance] = -np.inf
        draws[rows[:, k] >= search.high[k] - tolerance] = np.inf
        if name in ("stribeck_speed", "exponent"):
            draws[without_rise] = np.resize([-np.inf, np.inf], int(without_rise.sum()))
        draws.sort()
        low, high = min(draws[tail - 1], value), max(draws[count - tail], value)
        if name in wider or (name not in SIGNED and parameter.verdict == "not identifiable"):
            low, high = min(low, parameter.lower), max(high, parameter.upper)
        with np.errstate(invalid="ignore"):
            error = (high - low) / (2 * quantile(spare))
        result[name] = rated(value, float(low), float(high), float(error))
    return result
