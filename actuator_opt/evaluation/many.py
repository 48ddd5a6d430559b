"""All metrics and limits of many designs at once, with one governing value each."""

from __future__ import annotations

from collections.abc import Container, Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from ..base.numeric import Array
from .build import TOLERANCE
from .governing import governing
from .kernel import PreparedDesign, compute
from .limits import Limit, MetricArrays, all_limits, rows_of
from .values import Values


@dataclass(frozen=True, slots=True)
class Many:
    """Results of many designs, arrays (designs,).

    `metrics` are the governing values, NaN if missing; `margin` is the least margin of all limits,
    including the check list, and `missed` the index of its limit in `limits`. `read` are the PATHs
    that models and limits have read.
    """

    metrics: dict[str, Array]
    margin: Array
    missed: Array
    limits: tuple[Limit, ...]
    read: frozenset[str]

    @property
    def feasible(self) -> Array:
        """Whether requirements and checks are met, (designs,)."""
        found: Array = self.margin >= -TOLERANCE
        return found


@np.errstate(all="ignore")  # values that are not finite are NaN
def evaluate_many(
    subject: PreparedDesign,
    varied: Mapping[str, Array],
    count: int,
    wanted: Container[str] | None = None,
) -> Many:
    """Metrics and limits of designs that differ in some numbers.

    Parameters
    ----------
    subject : the design
    varied : arrays (designs,) by PATH, SI
    count : number of designs
    wanted : metrics to compute; default: all
    """
    v = subject.values(varied)
    computed = compute(subject, v).computed
    metrics = {
        name: _governing(name, computed, v, subject, count)
        for name in subject.quantities
        if wanted is None or name in wanted
    }
    limits = limits_of(subject)
    margin, missed = np.full(count, np.inf), np.zeros(count, dtype=np.int32)
    for number, value in _margins(limits, computed, v, count):
        worse = ~(value >= margin)  # NaN counts as the worst
        margin = np.where(worse, np.where(np.isnan(value), -np.inf, value), margin)
        missed[worse] = number
    return Many(metrics, margin, missed, limits, frozenset(v.read))


@np.errstate(all="ignore")
def margins_of(subject: PreparedDesign, varied: Mapping[str, Array], count: int) -> Array:
    """Margins of all limits of such designs, (limits, designs), in the order of `limits_of`.

    Infinity if a limit does not apply, NaN if its value is not finite.
    """
    v = subject.values(varied)
    limits = limits_of(subject)
    found = np.full((len(limits), count), np.inf)
    for number, value in _margins(limits, compute(subject, v).computed, v, count):
        found[number] = np.minimum(found[number], value)
    return found


def margins_many(
    subject: PreparedDesign, varied: Mapping[str, Array], count: int
) -> dict[str, Array]:
    """Margins of all limits (designs,) of designs that differ in some numbers, by name.

    Infinity if a limit does not apply; minus infinity if its value is unknown.
    """
    found = margins_of(subject, varied, count)
    return {
        limit.name: np.where(np.isnan(row), -np.inf, row)
        for limit, row in zip(limits_of(subject), found, strict=True)
    }


def _margins(
    limits: Sequence[Limit], computed: MetricArrays, v: Values, count: int
) -> Iterator[tuple[int, Array]]:
    """Index of a limit, with its margins (designs,) in one case at one place."""
    for number, limit in enumerate(limits):
        for row in rows_of(limit, computed, v):
            yield number, np.broadcast_to(row.margin, (count,))


def limits_of(subject: PreparedDesign) -> tuple[Limit, ...]:
    """Requirements and checks of a feasible design."""
    every = all_limits(subject.design, subject.plugins)
    return tuple(limit for limit in every if limit.origin != "advice")


def _governing(
    name: str, computed: MetricArrays, v: Values, subject: PreparedDesign, count: int
) -> Array:
    """Governing value of every design (count,); infinity (unlimited) does not count as a value."""
    found = governing(name, computed, v, subject)
    return np.broadcast_to(np.where(np.isfinite(found), found, np.nan), (count,))
