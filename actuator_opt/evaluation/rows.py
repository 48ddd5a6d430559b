"""Rows of computed metrics: one margin per limit, load case and place."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from ..base.numeric import Array, real, where
from ..metrics import METRICS
from .limits import Limit, margin
from .values import Values

ALL_CASES = "all"
UNLIMITED = 1e300
"""Replaces an infinite value (unloaded part) in margins, which must be finite."""


@dataclass(slots=True)
class MetricArrays:
    """Results of a kernel: metric → place → array, and reasons for missing metrics.

    Arrays are floats, (designs,), (cases, 1) or (cases, designs). A place is a ply, a seal or a
    part; "" if the metric has a single place. `applies` marks the cases of a metric, `applies_at`
    those of a place.
    """

    metrics: dict[str, dict[str, Array]] = field(default_factory=dict)
    why: dict[str, str] = field(default_factory=dict)
    applies: dict[str, Array] = field(default_factory=dict)
    applies_at: dict[tuple[str, str], Array] = field(default_factory=dict)
    friction_parts: dict[str, Array] = field(default_factory=dict)
    """Running friction of each seal; the parts sum to `friction_running`."""

    def put(self, name: str, value: Array | dict[str, Array], cases: Array = None) -> None:
        """Record a metric: an array, or an array per place; `cases` marks where it applies.

        Raises
        ------
        KeyError : `metrics.table` has no row with this name
        """
        if name not in METRICS:
            raise KeyError(f"metric {name}: add its row to metrics/table.py")
        self.metrics[name] = value if isinstance(value, dict) else {"": value}
        if cases is not None:
            self.applies[name] = cases

    def skip(self, name: str, why: str) -> None:
        """Record why a metric does not apply or is unknown."""
        self.why[name] = why


@dataclass(frozen=True, slots=True)
class LimitRow:
    """A limit in one case at one place: `value`, `limit` and `margin` are (designs,)."""

    limit_of: Limit
    case: str
    place: str
    value: Array
    limit: Array
    margin: Array
    case_index: int | None = None
    """Row index in the computed array, if it has a row per load case."""

    @property
    def label(self) -> str:
        """Name with case and place, unique among the rows of a design."""
        where = ", ".join(p for p in (self.case if self.case != ALL_CASES else "", self.place) if p)
        return f"{self.limit_of.name} ({where})" if where else self.limit_of.name


def by_case(
    computed: MetricArrays, metric: str, array: Array, cases: tuple[str, ...], place: str = ""
) -> Iterator[tuple[str, Array]]:
    """Split a computed array into (case name, (designs,) array) where the metric applies."""
    array = np.asarray(array)
    if array.ndim < 2:
        yield ALL_CASES, np.atleast_1d(array)
        return
    applies = computed.applies_at.get((metric, place), computed.applies.get(metric))
    for i, case in enumerate(cases):
        if applies is None or applies[i]:
            yield case, array[i]


def rows_of(limit: Limit, computed: MetricArrays, v: Values) -> Iterator[LimitRow]:
    """All rows of a limit; none if the metric was not computed."""
    bound = limit.value(v)
    for place, array in computed.metrics.get(limit.metric, {}).items():
        if limit.places is not None and place not in limit.places:
            continue
        for case, value in by_case(computed, limit.metric, array, v.cases, place):
            if limit.case is not None and case not in (ALL_CASES, limit.case):
                continue
            unlimited = real(value) == np.inf
            finite = where(unlimited, UNLIMITED, value)
            yield LimitRow(
                limit_of=limit,
                case=case,
                place=place,
                value=value,
                limit=bound,
                margin=margin(finite, bound, limit.sense),
                case_index=None if case == ALL_CASES else v.cases.index(case),
            )
