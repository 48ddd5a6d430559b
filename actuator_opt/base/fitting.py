"""Least-squares fits within limits, with confidence bounds and a verdict for each parameter.

`relaxed` solves many small problems at once, each from its own start; it is used for resampling.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from math import isfinite
from typing import Any, Literal, NamedTuple

import numpy as np

from .numeric import Array

FIRM, LIGHT, HEAVY = 1e-4, 1e-12, 1e8
"""Initial, smallest and largest damping of a Levenberg-Marquardt step, relative to the curvature
(our choice)."""
CONFIDENCE = 0.95
"""Confidence level of the bounds."""
NORMAL = 1.959964
"""Half width of a `CONFIDENCE` interval of a normal distribution, in standard errors."""
WEAK = 0.3
"""A parameter is identifiable if its confidence bounds deviate by at most this share of its
value."""
ROUNDING = 1e-6
"""If the confidence bounds deviate by at most this share of a parameter's scale, the parameter is
always identifiable, even if its value is 0 (such as an exponent)."""
RANK = 1e-7
"""Smallest usable ratio of singular values: below it, a step is lost in double-precision rounding
of the residuals."""
SEEN = 1e-4
"""A parameter is undetermined if more than this share of its direction (as squared components of a
unit vector) lies in combinations of parameters that the data do not determine."""

Verdict = Literal["identifiable", "weakly identifiable", "not identifiable"]


class Minimum(NamedTuple):
    """Minimum of a sum of squares: parameters `x`, and `cost`, which is half the sum."""

    x: Array
    cost: float


def solve(
    residuals: Callable[[Array], Array],
    start: Array,
    bounds: tuple[Array, Array],
    *,
    slopes: Callable[[Array], Array] | Literal["3-point"],
    sizes: Array | Literal["jac"],
    room: Array | float = 0.0,
    cost_tolerance: float = 1e-8,
    step_tolerance: float = 1e-8,
    slope_tolerance: float = 1e-8,
    most: int | None = None,
) -> Minimum:
    """Minimise sum r(x)^2/2 within bounds, by the trust-region reflective method of SciPy.

    Parameters
    ----------
    residuals : weighted residuals (points,) of parameters (n,)
    start : initial parameters (n,); they are moved inside the limits
    bounds : lower and upper limits (n,); may be infinite
    slopes : Jacobian of the residuals (points, n); "3-point": by central differences
    sizes : scales of the parameters (n,); "jac": from the Jacobian
    room : smallest distance of the start from the limits, since the method must start inside them
    cost_tolerance, step_tolerance, slope_tolerance : tolerances for convergence: relative change of
        the sum, relative step, scaled gradient
    most : largest number of evaluations; default: 100 per parameter
    """
    from scipy.optimize import least_squares  # slow to import, rarely needed

    low, high = bounds
    solution = least_squares(
        residuals,
        np.clip(start, low + room, high - room),
        jac=slopes,
        bounds=bounds,
        x_scale=sizes,
        ftol=cost_tolerance,
        xtol=step_tolerance,
        gtol=slope_tolerance,
        max_nfev=most,
    )
    return Minimum(solution.x, float(solution.cost))


class Parameter(NamedTuple):
    """A fitted value with its confidence bounds, SI; the bounds are infinite if undetermined."""

    value: float
    lower: float
    upper: float
    standard_error: float
    identifiable: bool
    """Whether both confidence bounds lie within 30 % of the value."""

    @property
    def verdict(self) -> Verdict:
        """Verdict on a parameter; "weakly identifiable" if the bounds only exclude zero."""
        if self.identifiable:
            return "identifiable"
        signed = self.lower > 0 or self.upper < 0
        return "weakly identifiable" if signed else "not identifiable"

    def to_dict(self) -> dict[str, Any]:
        """Plain data for JSON, SI; an infinite bound is null."""
        return {
            "value": self.value,
            "lower": self.lower if isfinite(self.lower) else None,
            "upper": self.upper if isfinite(self.upper) else None,
            "identifiable": self.identifiable,
            "verdict": self.verdict,
        }


def rated(value: float, lower: float, upper: float, standard_error: float) -> Parameter:
    """Rate a value by its bounds: it is identifiable if they lie within `WEAK` of the value."""
    near = max(value - lower, upper - value) <= WEAK * abs(value)
    return Parameter(value, lower, upper, standard_error, bool(near))


class FittedParameters(NamedTuple):
    """Fitted parameters and their covariance; undetermined parameters have infinite variance."""

    parameters: dict[str, Parameter]
    covariance: Array
    rank: int
    quantile: float
    """Student's t for the confidence bounds; infinite without degrees of freedom."""


def quantile(spare: float) -> float:
    """Student's t for two-sided 95 % confidence bounds; infinite without degrees of freedom."""
    from scipy.special import stdtrit  # slow to import, rarely needed

    return float(stdtrit(spare, (1 + CONFIDENCE) / 2)) if spare > 0 else np.inf


def known(
    values: Mapping[str, float],
    slopes: Array,
    residuals: Array,
    sizes: Array,
    *,
    spare: float | None = None,
) -> FittedParameters:
    """Confidence bounds from the linearised model and Student's t [SeberWild1989].

    The covariance is s^2 (J^T J)^-1 with s^2 = sum r^2/(n - p), where J is the Jacobian `slopes`
    and r the residuals of n points and p parameters. It covers only directions that the points
    determine; a parameter with a component in another direction is undetermined.

    Parameters
    ----------
    values : least-squares parameters by name
    slopes : Jacobian of the weighted model (points, parameters)
    residuals : weighted residuals (points)
    sizes : scale of each parameter (parameters): its value, or more if it may be 0
    spare : degrees of freedom; default: n - p

    Returns
    -------
    parameters, covariance and rank
    """
    count = len(values)
    free = residuals.size - count if spare is None else spare
    _, singular, right = np.linalg.svd(slopes * sizes, full_matrices=False)
    resolved = singular > RANK * singular[0] if singular.size and singular[0] > 0 else singular > 0
    rank = int(np.count_nonzero(resolved))
    t = quantile(free)
    if free <= 0:
        covariance = np.full((count, count), np.inf)
    else:
        scaled = right[resolved] / singular[resolved, None]
        unresolved_share = 1 - np.sum(right[resolved] ** 2, axis=0)
        variance = float(np.sum(residuals**2)) / free
        covariance = variance * (scaled.T @ scaled) * np.outer(sizes, sizes)
        undetermined = unresolved_share > SEEN
        covariance[undetermined] = covariance[:, undetermined] = np.inf
    parameters = {}
    for k, (name, value) in enumerate(values.items()):
        error = float(np.sqrt(covariance[k, k]))
        half = t * error
        identifiable = half <= max(WEAK * abs(value), ROUNDING * float(sizes[k]))
        middle = float(value)
        parameters[name] = Parameter(
            middle, middle - half, middle + half, error, bool(identifiable)
        )
    return FittedParameters(parameters, covariance, rank, t)


SETTLED = 1e-6
"""The search continues while a step reduces the cost by more than this share (our choice: with 100
residuals, the remaining error is a hundredth of a standard error)."""
LOST = 1e3
"""A problem without progress is abandoned above this damping (our choice: steps are then a
thousandth of the undamped step)."""


class FitSearch(NamedTuple):
    """Names of the numbers to fit, with their limits."""

    names: tuple[str, ...]
    low: Array
    high: Array


def relaxed(
    misfit: Callable[[Array, Array], Array],
    slopes: Callable[[Array], Array],
    rows: Array,
    search: FitSearch,
    steps: int,
) -> tuple[Array, Array]:
    """Solve many least-squares problems at once, each from its own start, within limits.

    The search takes Levenberg-Marquardt steps. A number at a limit stays there as long as it
    would have to pass the limit to reduce the cost.

    Parameters
    ----------
    misfit : function of trial numbers (one row for each problem) and the indices of these problems;
        returns their residuals (problems, residuals)
    slopes : function of the same rows; returns the derivatives of the residuals (problems,
        residuals, searched numbers); the first axis may have length 1
    rows : start of each problem (problems, searched numbers)
    search : names and limits of the searched numbers
    steps : largest number of steps

    Returns
    -------
    optima (problems, searched numbers), costs (problems,)
    """
    x = np.clip(rows, search.low, search.high)
    at = np.arange(x.shape[0])
    residuals = misfit(x, at)
    cost = np.sum(residuals**2, axis=1)
    damping = np.full(x.shape[0], FIRM)
    for _ in range(steps):
        jacobian = slopes(x[at])
        gradient = np.einsum("...ij,...i->...j", jacobian, residuals[at])
        at_limit = ((x[at] <= search.low) & (gradient > 0)) | (
            (x[at] >= search.high) & (gradient < 0)
        )
        normal = np.where(
            at_limit[:, :, None] | at_limit[:, None, :], 0.0, jacobian.swapaxes(-1, -2) @ jacobian
        )
        diagonal = np.einsum("...ii->...i", normal)
        size = np.sqrt(np.where(diagonal > 0, diagonal, 1.0))
        scaled = normal / (size[:, :, None] * size[:, None, :])
        scaled = scaled + np.eye(x.shape[1]) * (
            damping[at, None, None] + np.where(diagonal > 0, 0.0, 1.0)[:, :, None]
        )
        move = np.linalg.solve(scaled, (np.where(at_limit, 0.0, gradient) / size)[..., None])[
            ..., 0
        ]
        trial = np.clip(x[at] - move / size, search.low, search.high)
        trial_residuals = misfit(trial, at)
        trial_cost = np.sum(trial_residuals**2, axis=1)
        better = trial_cost < cost[at]
        progressing = better & (cost[at] - trial_cost > SETTLED * cost[at])
        damping[at] = np.clip(damping[at] * np.where(better, 0.1, 10.0), LIGHT, HEAVY)
        improved = at[better]
        x[improved], residuals[improved], cost[improved] = (
            trial[better],
            trial_residuals[better],
            trial_cost[better],
        )
        at = at[progressing | (~better & (damping[at] < LOST))]
        if not at.size:
            break
    return x, cost
