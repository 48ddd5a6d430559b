"""Many small least-squares problems at once, each with its own start: refits of resamples."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from ..base.numeric import Array

SETTLED = 1e-6
"""Relative cost reduction that a step must achieve to continue (a choice: with 100 residuals the
rest is a hundredth of a standard error)."""
FIRM, LIGHT, HEAVY = 1e-4, 1e-12, 1e8
"""First, least and greatest damping of a step relative to the curvature (a choice, as in
Marquardt's)."""
LOST = 1e3
"""Damping at which a problem without progress is given up (a choice: steps are then a thousandth of
the undamped one)."""


class FitSearch(NamedTuple):
    """Searched numbers with their limits."""

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
    """Solve many least-squares problems at once, each from its row, within limits.

    Levenberg-Marquardt steps; a number that the cost pushes against a limit stays there.

    Parameters
    ----------
    misfit : residuals of rows (rows, residuals), for the problems with the given indices
    slopes : derivatives at rows (rows or 1, residuals, searched)
    rows : start of each problem (problems, searched)
    search : limits
    steps : maximum number

    Returns
    -------
    optima (problems, searched), costs (problems,)
    """
    x = np.clip(rows, search.low, search.high)
    at = np.arange(x.shape[0])
    rest = misfit(x, at)
    cost = np.sum(rest**2, axis=1)
    damping = np.full(x.shape[0], FIRM)
    for _ in range(steps):
        own = slopes(x[at])
        down = np.einsum("...ij,...i->...j", own, rest[at])
        held = ((x[at] <= search.low) & (down > 0)) | ((x[at] >= search.high) & (down < 0))
        normal = np.where(held[:, :, None] | held[:, None, :], 0.0, own.swapaxes(-1, -2) @ own)
        diagonal = np.einsum("...ii->...i", normal)
        size = np.sqrt(np.where(diagonal > 0, diagonal, 1.0))
        scaled = normal / (size[:, :, None] * size[:, None, :])
        scaled = scaled + np.eye(x.shape[1]) * (
            damping[at, None, None] + np.where(diagonal > 0, 0.0, 1.0)[:, :, None]
        )
        move = np.linalg.solve(scaled, (np.where(held, 0.0, down) / size)[..., None])[..., 0]
        trial = np.clip(x[at] - move / size, search.low, search.high)
        tried = misfit(trial, at)
        new = np.sum(tried**2, axis=1)
        better = new < cost[at]
        won = better & (cost[at] - new > SETTLED * cost[at])
        damping[at] = np.clip(damping[at] * np.where(better, 0.1, 10.0), LIGHT, HEAVY)
        kept = at[better]
        x[kept], rest[kept], cost[kept] = trial[better], tried[better], new[better]
        at = at[won | (~better & (damping[at] < LOST))]
        if not at.size:
            break
    return x, cost
