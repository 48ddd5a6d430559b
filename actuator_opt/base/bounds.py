"""Limits of numbers in command options, and names of the figures of a sweep."""

from __future__ import annotations

from typing import NamedTuple


class IntegerRange(NamedTuple):
    """Lower and upper bound of a whole number."""

    least: int
    most: int


STARTS = IntegerRange(1, 1000)
"""Allowed number of local searches."""


CHECKS = IntegerRange(0, 100)
"""Allowed number of full searches that check a front."""


SEED = IntegerRange(0, 2**32 - 1)
"""Seeds that every random generator accepts; the limit is NLopt, whose seed has only 32 bits."""


FRONT = IntegerRange(3, 2000)
"""Allowed number of designs on a front."""


SWEEP_FIGURES = ("parallel", "scatter", "contour", "ucurves")
"""Figures of a sweep; each is named like the module of `pages.sweep_figures` that draws it."""
