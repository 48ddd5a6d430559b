"""A chart as data: panels with axes, curves, points, limits and shaded maps.

Scales are linear, logarithmic, logarithmic in both directions from zero, or named rows. A chart
contains values and words; `chart_layout` computes their positions, and `chart_ink` draws them.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from typing import Literal, TypeAlias

import numpy as np

from ..base.dataclass import dataclass
from ..base.numeric import Array
from .axes import Ticks, even_range, even_ticks, level_ticks, log_range, ticks
from .ink import text_width
from .text import MINUS, number

Values: TypeAlias = Sequence[float] | Array
Weight: TypeAlias = Literal["normal", "thin", "guide", "broad"]
PointWeight: TypeAlias = Literal["normal", "guide", "strong"]


@dataclass(frozen=True, slots=True)
class Axis:
    """An axis of a panel.

    A panel without an x label shares the x axis of the next panel below it.

    Parameters
    ----------
    label : quantity and unit
    log : whether the axis is logarithmic; values at or below zero are not shown, unless `signed`
    signed : whether the axis extends in both directions from zero; with `log`, it is linear near
        zero and logarithmic beyond
    zero : whether the axis always includes zero
    range : values at both ends; default: from the values shown
    ticks : values and their labels; default: round values
    names : names of rows, if the axis has rows instead of values. Row k is at the value k; row 0 is
        at the top
    """

    label: str = ""
    log: bool = False
    signed: bool = False
    zero: bool = False
    range: tuple[float, float] | None = None
    ticks: Sequence[tuple[float, str]] | None = None
    names: Sequence[str] = ()


@dataclass(frozen=True, slots=True, eq=False)
class Curve:
    """A line through values; it is interrupted where a value is NaN.

    Parameters
    ----------
    words : name of the curve; empty for none
    xs, ys : values
    low, high : bounds of a band around the curve
    style : colour and dash by number; default: its index among the curves of the panel
    weight : "thin" for a record over time, "guide" for a grey hairline, "broad" for a pale line
        under the other curves
    end : words at the right end of the curve
    dash : dash by number; default: the dash of its style
    """

    words: str
    xs: Values
    ys: Values
    low: Values = ()
    high: Values = ()
    style: int | None = None
    weight: Weight = "normal"
    end: str = ""
    dash: int | None = None


@dataclass(frozen=True, slots=True, eq=False)
class Points:
    """Single values with their error bars.

    Parameters
    ----------
    words : name of the points; empty for none
    xs, ys : values
    low, high : ends of the error bars
    style : colour by number; default: the index of these `Points` in the panel
    small : whether small dots and crosses are drawn, in the colours of the curves
    across : whether error bars are along x instead of y
    shades : value of each point on the scale of the panel's shaded map, which gives its fill
    labels : words beside each point
    weight : "guide" for pale dots in the background, "strong" for a ring around a chosen point
    """

    words: str
    xs: Values
    ys: Values
    low: Values = ()
    high: Values = ()
    style: int | None = None
    small: bool = False
    across: bool = False
    shades: Values = ()
    labels: Sequence[str] = ()
    weight: PointWeight = "normal"


@dataclass(frozen=True, slots=True)
class Level:
    """A horizontal line at a value of y, or a vertical line at a value of x.

    Parameters
    ----------
    value : value of y, or of x if `upright`
    words : its name
    sense : "min" or "max" if the line is a limit. A limit is red, its forbidden side is hatched,
        and its name is to the right of the frame (above it if `upright`)
    style : colour and dash by number, if the line is not a limit
    between : both ends (x) of a short horizontal line, whose name is beside it; default: the line
        is as wide as the frame
    upright : whether the line is vertical, at a value of x
    """

    value: float
    words: str
    sense: Literal["", "min", "max"] = ""
    style: int = 2
    between: tuple[float, float] | None = None
    upright: bool = False


@dataclass(frozen=True, slots=True, eq=False)
class Area:
    """The filled area between two curves over x; its name is to the right of the frame.

    Parameters
    ----------
    words : its name
    xs, low, high : values
    fill : fill colour by number
    """

    words: str
    xs: Values
    low: Values
    high: Values
    fill: int = 0


@dataclass(frozen=True, slots=True)
class Stretch:
    """A shaded range of x; each line of its words is above the frame if it fits there."""

    start: float
    end: float
    words: str = ""
    shade: int = 0


@dataclass(frozen=True, slots=True, eq=False)
class ShadedMap:
    """A positive quantity over x (columns) and y (rows), shaded between levels at round numbers.

    The map is hatched where values are missing.
    """

    xs: Values
    ys: Values
    values: Array


@dataclass(frozen=True, slots=True, eq=False)
class Panel:
    """A frame with its axes.

    Parameters
    ----------
    title : quantity and unit of y
    x, y : axes
    curves, points, levels, surface, stretches : content of the frame
    note : words below the title, or in an empty frame, where they state the reason
    share : relative height among the panels of a column
    areas : filled areas
    """

    title: str
    x: Axis = Axis()
    y: Axis = Axis()
    curves: Sequence[Curve] = ()
    points: Sequence[Points] = ()
    levels: Sequence[Level] = ()
    surface: ShadedMap | None = None
    note: str = ""
    share: float = 1.0
    areas: Sequence[Area] = ()
    stretches: Sequence[Stretch] = ()


CORE = 0.35
"""Width in decades of the linear part around zero of an axis that is logarithmic in both directions
(our choice)."""
DECADE = 8.0
"""Ratio of largest to smallest magnitude above which a signed axis is logarithmic (our choice)."""
LARGEST, SMALLEST = 1e150, 1e-100
"""Values with larger magnitudes are not shown, as their differences overflow; those with smaller
magnitudes count as zero."""
SIZE = 6.5
"""Type size of ticks [pt]."""
Ranked: TypeAlias = list[tuple[float, str, int]]
"""Ticks (value, words, rank); ticks of low rank have priority."""


def known(values: Iterable[float], *, log: bool = False) -> list[float]:
    """The values that an axis can show: finite, and positive if the axis is logarithmic."""
    array = _sized(np.asarray(list(values), dtype=float))
    finite: list[float] = array[array > 0 if log else np.isfinite(array)].tolist()
    return finite


def _sized(values: Array) -> Array:
    """The values, with those too small for an axis set to zero and those too large set to NaN."""
    sizes = np.abs(values)
    return np.where(sizes <= LARGEST, np.where(sizes < SMALLEST, 0.0, values), np.nan)


@dataclass(frozen=True, slots=True)
class Scale:
    """The scale of an axis: positions of values, both ends, and candidate ticks."""

    places: Callable[[Array], Array]
    range: tuple[float, float]
    candidates: Callable[[int], Ranked]

    def at(self, values: Values) -> Array:
        """Positions of values along the axis; NaN for values that are not shown."""
        return self.places(_sized(np.asarray(values, dtype=float)))

    def place(self, value: float) -> float:
        """Position of a value along the axis."""
        return float(self.at([value])[0])

    def ticks(self, room: float, *, across: bool) -> Ticks:
        """Ticks for an axis of length `room` [mm] whose words do not touch."""
        count = min(max(2, int(room / 9.0)), 10) if across else min(max(2, round(room / 8.0)), 6)
        low, high = self.range
        ranked = [tick for tick in self.candidates(count) if low - 1e-9 <= tick[0] <= high + 1e-9]
        ranked.sort(key=lambda tick: (tick[2], abs(tick[0])))
        labels = self._spaced(ranked, room, across)
        if len(labels) < 2:  # label both ends rather than only zero
            ranked = sorted(ranked, key=lambda tick: -abs(tick[0]))
            labels = self._spaced(ranked, room, across)
        return labels

    def _spaced(self, ranked: Ranked, room: float, across: bool) -> Ticks:
        labels: list[tuple[float, str]] = []
        for place, words, _ in ranked:
            if all(self._apart(place, words, tick, room, across) for tick in labels):
                labels.append((place, words))
        return sorted(labels)

    def _apart(
        self, place: float, words: str, tick: tuple[float, str], room: float, across: bool
    ) -> bool:
        distance = abs(place - tick[0]) / (self.range[1] - self.range[0]) * room
        if not across:
            return distance > 2.8
        return distance > (text_width(words, SIZE) + text_width(tick[1], SIZE)) / 2 + 1.0


def scale(axis: Axis, values: Sequence[float], *, exact: bool = False) -> Scale:
    """The scale of an axis for its values; with `exact`, its ends are the extreme values."""
    if axis.names:
        return _rows(axis)
    if axis.signed and (speeds := [abs(value) for value in known(values) if value]):
        low, high = min(speeds), max(speeds)
        ways = [way for way in (1, -1) if any(way * value > 0 for value in known(values))]
        if axis.log and high / low > DECADE:
            return _both_ways(low, 1.12 * high, ways)
        ends = (-1.12 * high if -1 in ways else 0.0, 1.12 * high if 1 in ways else 0.0)
        return _straight(axis, ends)
    if axis.log and not axis.signed:
        return _logarithmic(axis, known(values, log=True), exact)
    shown = known(values)
    if axis.range is not None:
        return _straight(axis, _wide(axis.range))
    if exact and shown and max(shown) - min(shown) > 1e-9 * max(map(abs, shown)):
        whole = [*shown, 0.0] if axis.zero else shown
        return _straight(axis, (min(whole), max(whole)))
    return _straight(axis, _wide(even_range(shown, zero=axis.zero)))


def _wide(ends: tuple[float, float]) -> tuple[float, float]:
    """The ends of a range, widened if they coincide."""
    low, high = ends
    least = 1e-9 * max(abs(low), abs(high)) or 1.0
    return ends if high - low >= least else (low - least, low + least)


def _stated(axis: Axis, at: Callable[[float], float]) -> Ranked:
    return [(at(value), words, 0) for value, words in axis.ticks or ()]


def _straight(axis: Axis, ends: tuple[float, float]) -> Scale:
    def candidates(count: int) -> Ranked:
        if axis.ticks is not None:
            return _stated(axis, float)
        return [(value, words, 1) for value, words in _even(*ends, count)]

    return Scale(lambda values: values, ends, candidates)


def _even(low: float, high: float, count: int) -> Ticks:
    """Ticks at round numbers; very large and very small values are written with a power of ten."""
    size = max(abs(low), abs(high))
    if 1e-3 <= size < 1e6:
        return even_ticks(low, high, count)
    power = 10.0 ** math.floor(math.log10(size))
    values = [power * value for value in ticks(low / power, high / power, count)]
    for digits in range(2, 9):
        words = [number(value, digits) for value in values]
        if len({*words}) == len(words):
            break
    return list(zip(values, words, strict=True))


def _logarithmic(axis: Axis, values: Sequence[float], exact: bool) -> Scale:
    bounds = axis.range if axis.range is not None and min(axis.range) > 0 else None
    if bounds is not None:
        ends = (math.log10(bounds[0]), math.log10(bounds[1]))
    elif exact and values and max(values) > 1.5 * min(values):
        ends = (math.log10(min(values)), math.log10(max(values)))
    else:
        ends = log_range(values or [1.0])

    def at(values: Array) -> Array:
        return np.log10(np.where(values > 0, values, np.nan))

    def candidates(count: int) -> Ranked:
        if axis.ticks is not None:
            return _stated(axis, math.log10)
        levels = level_ticks(*ends)
        if len(levels) < 2:
            even = _even(10.0 ** ends[0], 10.0 ** ends[1], 3)
            levels = [(math.log10(value), words) for value, words in even if value > 0]
        return [(place, words, int(abs(place - round(place)) > 1e-9)) for place, words in levels]

    return Scale(at, ends, candidates)


def _both_ways(low: float, high: float, ways: Sequence[int]) -> Scale:
    """Scale that is logarithmic in both directions from zero, with a linear part around zero."""

    def at(values: Array) -> Array:
        size = np.maximum(np.abs(values), low)  # NaN stays
        outside = np.copysign(CORE + np.log10(size) - math.log10(low), values)
        return np.where(size <= low, CORE * values / low, outside)

    end = CORE + math.log10(high / low)
    ends = (-end if -1 in ways else 0.0, end if 1 in ways else 0.0)

    def candidates(count: int) -> Ranked:
        ranked: Ranked = [(0.0, "0", 0)]
        for place, words in level_ticks(math.log10(low), math.log10(high)):
            rank = 1 if abs(place - round(place)) < 1e-9 else 2
            along = CORE + place - math.log10(low)
            ranked += [(way * along, words if way > 0 else MINUS + words, rank) for way in ways]
        return ranked

    return Scale(at, ends, candidates)


def _rows(axis: Axis) -> Scale:
    """Scale of named rows, the first at the top."""
    count = len(axis.names)
    ticks: Ranked = [(-float(k), name, 0) for k, name in enumerate(axis.names)]
    return Scale(lambda values: -values, (0.5 - count, 0.5), lambda _: ticks)
