"""A chart as data: panels with axes, curves, points, limits and shaded maps.

A chart names values and words. `chart_ink` gives them their place on paper by rule.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, TypeAlias

from ..base.numeric import Array

Values: TypeAlias = Sequence[float] | Array
Weight: TypeAlias = Literal["normal", "thin", "guide"]


@dataclass(frozen=True, slots=True)
class Axis:
    """An axis of a panel.

    Of panels above each other, one without an x label shares the x axis of the next one below.

    Parameters
    ----------
    label : quantity and unit
    log : logarithmic; values at or below zero have no place, unless `signed`
    signed : both ways about zero; with `log`, logarithmic outside a straight core
    zero : the axis includes zero
    range : both ends; default: by the values
    ticks : places and words; default: round values
    names : of rows, the first at the top; row k lies at the value k
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
    """A line through values; a value that is not a number interrupts it.

    Parameters
    ----------
    words : its name; empty: not named
    xs, ys : values
    low, high : bounds of a band around it
    style : colour and dash by number; default: its place among the curves of the panel
    weight : "thin" for a record over time, "guide" for a grey hairline
    end : words at its right end
    """

    words: str
    xs: Values
    ys: Values
    low: Values = ()
    high: Values = ()
    style: int | None = None
    weight: Weight = "normal"
    end: str = ""


@dataclass(frozen=True, slots=True, eq=False)
class Points:
    """Single values with their error bars.

    Parameters
    ----------
    words : their name; empty: not named
    xs, ys : values
    low, high : ends of the error bars, along y, or along x where `across`
    style : colour by number; default: their place among the points of the panel
    small : small dots and crosses in the colours of the curves
    across : error bars along x
    shades : values that fill the points with the shade of the panel's surface
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


@dataclass(frozen=True, slots=True)
class Level:
    """A horizontal line at a value of y.

    Parameters
    ----------
    value : of y
    words : its name
    sense : of a limit, "min" or "max": red, the forbidden side hatched, named at the right
    style : of any other line: colour and dash by number
    between : ends along x; its name then stands beside it; default: the whole frame
    """

    value: float
    words: str
    sense: Literal["", "min", "max"] = ""
    style: int = 2
    between: tuple[float, float] | None = None


@dataclass(frozen=True, slots=True, eq=False)
class Surface:
    """A quantity above zero over x (columns) and y (rows), shaded between round levels."""

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
    curves, points, levels, surface : what it shows
    note : below the title, or inside an empty frame, why it is empty
    share : of the height, among the panels of a column
    """

    title: str
    x: Axis = Axis()
    y: Axis = Axis()
    curves: Sequence[Curve] = ()
    points: Sequence[Points] = ()
    levels: Sequence[Level] = ()
    surface: Surface | None = None
    note: str = ""
    share: float = 1.0
