"""Limits of the numbers that commands accept, and the figures of a sweep by name."""

from __future__ import annotations

from typing import NamedTuple


class IntegerRange(NamedTuple):
    """Lower and upper bound of a whole number."""

    least: int
    most: int


STARTS = IntegerRange(1, 1000)
"""Number of local searches."""


CHECKS = IntegerRange(0, 100)
"""Number of full searches for a front."""


SEED = IntegerRange(0, 2**32 - 1)
"""Seeds that every generator accepts: NLopt's is an unsigned long, which may have 32 bits."""


FRONT = IntegerRange(3, 2000)
"""Number of designs on a front."""


SWEEP_FIGURES = ("parallel", "scatter", "contour", "ucurves")
"""Figures of a sweep, named as the modules of `pages.sweep_figures` that draw them."""
