"""Least squares within bounds, and how well a fit knows each parameter: bounds, and a verdict."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from math import isfinite
from typing import Any, Literal, NamedTuple

import numpy as np

from .numeric import Array

CONFIDENCE = 0.95
"""Share of repeated tests whose bounds would hold the true value."""
NORMAL = 1.959964
"""Standard errors of bounds of `CONFIDENCE` of a normal distribution, its quantile of 0.975."""
WEAK = 0.3
"""A parameter is known when its bounds lie within this share of its value."""
ROUNDING = 1e-6
"""Bounds within this share of a parameter's size are near enough: an exponent of 0 is known too."""
RANK = 1e-7
"""Least ratio of singular values: below it a residual in double precision does not see a step."""
SEEN = 1e-4
"""Share of a parameter's step that may lie in directions the points do not see."""

Verdict = Literal["identifiable", "weakly identifiable", "not identifiable"]


class Minimum(NamedTuple):
    """Where a sum of squares is least, and half of it there."""

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
    start : parameters (n,), moved inside the bounds
    bounds : least and greatest parameters (n,); may be infinite
    slopes : of the residuals (points, n), or by central differences
    sizes : of the parameters (n,), or by the slopes
    room : least distance of the start from the bounds, as the method starts inside
    cost_tolerance, step_tolerance, slope_tolerance : relative change of the sum, relative step, and
        scaled slope at which it ends
    most : evaluations; default: 100 a parameter
    """
    from scipy.optimize import least_squares  # slow to import, rarely needed

    low, high = bounds
    found = least_squares(
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
    return Minimum(found.x, float(found.cost))


class Parameter(NamedTuple):
    """A fitted value with its bounds, SI; the bounds are infinite where nothing bounds it."""

    value: float
    lower: float
    upper: float
    standard_error: float
    identifiable: bool
    """Whether the bounds lie within 30 % of the value."""

    @property
    def verdict(self) -> Verdict:
        """Identifiable; weakly so while the bounds keep the value's sign; else not."""
        if self.identifiable:
            return "identifiable"
        signed = self.lower > 0 or self.upper < 0
        return "weakly identifiable" if signed else "not identifiable"

    def to_dict(self) -> dict[str, Any]:
        """As plain data for JSON, SI; an infinite bound is null."""
        return {
            "value": self.value,
            "lower": self.lower if isfinite(self.lower) else None,
            "upper": self.upper if isfinite(self.upper) else None,
            "identifiable": self.identifiable,
            "verdict": self.verdict,
        }


def rated(value: float, lower: float, upper: float, standard_error: float) -> Parameter:
    """A value with its bounds, judged: identifiable within `WEAK` of it."""
    near = max(value - lower, upper - value) <= WEAK * abs(value)
    return Parameter(value, lower, upper, standard_error, bool(near))


class Known(NamedTuple):
    """Parameters of a fit with their covariance; infinite where the points leave one open."""

    parameters: dict[str, Parameter]
    covariance: Array
    rank: int
    quantile: float
    """Student's t of the bounds; infinite without spare points."""


def quantile(spare: float) -> float:
    """Student's t that holds 95 % between -t and t; infinite without a spare point."""
    from scipy.special import stdtrit  # slow to import, rarely needed

    return float(stdtrit(spare, (1 + CONFIDENCE) / 2)) if spare > 0 else np.inf


def known(
    values: Mapping[str, float],
    slopes: Array,
    residuals: Array,
    sizes: Array,
    *,
    spare: float | None = None,
) -> Known:
    """Bounds of the linearised model with Student's t [SeberWild1989].

    Covariance s^2 (J^T J)^-1, s^2 = sum r^2/(n - p), in the directions that the points see; a
    parameter with a part outside them is open.

    Parameters
    ----------
    values : least-squares parameters by name
    slopes : of the weighted model by the parameters (points, parameters)
    residuals : weighted (points)
    sizes : step of each parameter that matters (parameters): its size, or more where it may be 0
    spare : points beyond those the parameters take; default: n - p

    Returns
    -------
    what is known
    """
    count = len(values)
    free = residuals.size - count if spare is None else spare
    _, singular, right = np.linalg.svd(slopes * sizes, full_matrices=False)
    seen = singular > RANK * singular[0] if singular.size and singular[0] > 0 else singular > 0
    rank = int(np.count_nonzero(seen))
    t = quantile(free)
    if free <= 0:
        covariance = np.full((count, count), np.inf)
    else:
        scaled = right[seen] / singular[seen, None]
        hidden = 1 - np.sum(right[seen] ** 2, axis=0)
        variance = float(np.sum(residuals**2)) / free
        covariance = variance * (scaled.T @ scaled) * np.outer(sizes, sizes)
        unseen = hidden > SEEN
        covariance[unseen] = covariance[:, unseen] = np.inf
    parameters = {}
    for k, (name, value) in enumerate(values.items()):
        error = float(np.sqrt(covariance[k, k]))
        half = t * error
        near = half <= max(WEAK * abs(value), ROUNDING * float(sizes[k]))
        middle = float(value)
        parameters[name] = Parameter(middle, middle - half, middle + half, error, bool(near))
    return Known(parameters, covariance, rank, t)
