"""What commands take, wherever they come from: bounds of numbers, words of figures."""

from __future__ import annotations

from typing import NamedTuple


class Bounds(NamedTuple):
    """The least and the greatest of a whole number."""

    least: int
    most: int


STARTS = Bounds(1, 1000)
"""Local searches."""
CHECKS = Bounds(0, 100)
"""Full searches of a front."""
SEED = Bounds(0, 2**32 - 1)
"""What every generator takes: NLopt's is an unsigned long, which may have 32 bits."""
FRONT = Bounds(3, 2000)
"""Designs of a front."""

SWEEP_FIGURES = ("parallel", "scatter", "contour", "ucurves")
"""Figures of a sweep, named as the modules of `pages.sweep_figures` that draw them."""
