"""Metering edges by a curve: flow coefficient of each edge over the share of the full signal.

The points of a curve are joined by monotone cubics, so the flow has a continuous slope over the
signal and does not overshoot its points. Beyond the first and the last point it is constant.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from ..base.dataclass import dataclass
from ..base.numeric import Array, absolute, clip, positive, real, where
from .valve import edge_conductance, edge_flow

NULL = 0.01
"""Rise of the flow coefficient at which an edge counts as open, as a share of its whole rise. Our
choice: nearer to the edge, the slope of a curve with a dead band tends to zero."""
STEEP = 0.1
"""Slope at the first point, as a share of the steepest secant, from which an edge counts as open
there (our choice): the curve has no dead band then."""


@dataclass(frozen=True, slots=True)
class MeteringCurve:
    """Points of a rising curve, with the slopes of the cubics that join them."""

    places: tuple[Array, ...]
    """Shares of the full signal in the direction that opens the edge, rising."""
    values: tuple[Array, ...]
    slopes: tuple[Array, ...]
    start: Array = 0.0
    """Share at which the edge counts as open: the first place, or with a dead band that at which
    the curve has risen by `NULL` of its whole rise."""

    @classmethod
    def through(cls, places: Sequence[float], values: Sequence[float]) -> MeteringCurve:
        """The curve through at least two points whose places rise and whose values do not fall."""
        slopes = monotone_slopes(places=places, values=values)
        curve = cls(tuple(places), tuple(values), tuple(float(slope) for slope in slopes))
        secants = [
            (y1 - y0) / (x1 - x0)
            for (x0, y0), (x1, y1) in pairwise(zip(places, values, strict=True))
        ]
        if curve.slopes[0] >= STEEP * max(secants):
            return cls(curve.places, curve.values, curve.slopes, float(places[0]))
        level = values[0] + NULL * (values[-1] - values[0])
        low, high = float(places[0]), float(places[-1])
        for _ in range(60):  # halves the bracket to rounding
            middle = 0.5 * (low + high)
            below = float(curve_value(curve=curve, share=middle)) < level
            low, high = (middle, high) if below else (low, middle)
        return cls(curve.places, curve.values, curve.slopes, high)


@dataclass(frozen=True, slots=True)
class CurveEdge:
    """One metering edge with the coefficient K = K0 + k f(share)."""

    curve: MeteringCurve
    factor: Array = 1.0
    """k [m^3/s/sqrt(Pa)], times the unit of the curve's values."""
    leakage: Array = 0.0
    """K0 [m^3/s/sqrt(Pa)]."""

    @property
    def overlap(self) -> Array:
        """Share of the full signal at which the edge opens."""
        return self.curve.start

    def coefficient(self, share: Array) -> Array:
        """Flow coefficient at a share of the full signal [m^3/s/sqrt(Pa)]."""
        return self.leakage + self.factor * curve_value(curve=self.curve, share=share)


@dataclass(frozen=True, slots=True)
class CurveSpool:
    """A spool whose edges follow curves over the signal; its place is a share of the signal."""

    supply_a: CurveEdge
    supply_b: CurveEdge
    a_tank: CurveEdge
    b_tank: CurveEdge
    full_signal: Array
    """Signal at the end of the curves [V], > 0."""
    stroke: Array = 1.0

    def start(self, edge: CurveEdge) -> Array:
        """Share of the full signal at which an edge counts as open."""
        return edge.overlap

    def opened(self, edge: CurveEdge) -> Array:
        """Share of the full signal at which an edge is open beyond its leakage."""
        return edge.overlap

    def signal_share(self, stroke: float) -> float:
        """Share of the full signal at which the spool is at a place: the place itself."""
        return min(stroke, 1.0)

    def position(self, signal: Array) -> Array:
        """Share of the full signal, at most 1 either way."""
        return clip(signal / positive(self.full_signal), -1.0, 1.0)

    def position_slope(self, place: Array) -> Array:
        """Slope of the share over the signal [1/V]."""
        return 1.0 / positive(self.full_signal) + 0 * place

    def edge_flow(self, edge: CurveEdge, place: Array, drop: Array) -> Array:
        """Flow through an edge, with a share of the full signal that opens it [m^3/s]."""
        return edge_flow(coefficient=edge.coefficient(place), pressure_drop=drop)

    def edge_gain(
        self, edge: CurveEdge, place: Array, drop: Array, *, opens: bool = False
    ) -> Array:
        """Slope of that flow over the share [m^3/s]; `opens`: the edge is about to open."""
        slope = edge.factor * curve_slope(curve=edge.curve, share=place, opens=opens)
        return edge_flow(coefficient=slope, pressure_drop=drop)

    def edge_conductance(self, edge: CurveEdge, place: Array, drop: Array) -> Array:
        """Slope of that flow over the pressure drop [m^3/s/Pa]."""
        return edge_conductance(coefficient=edge.coefficient(place), pressure_drop=drop)


def monotone_slopes(*, places: Sequence[Array], values: Sequence[Array]) -> list[Array]:
    """Slopes of the cubics that join points without overshoot, at every point.

    Between two secants of equal sign, m = (w1 + w2)/(w1/d1 + w2/d2), with w1 = 2 h2 + h1 and
    w2 = h2 + 2 h1; else m = 0. At the ends m = ((2 h1 + h2) d1 - h1 d2)/(h1 + h2), between 0 and
    3 d1. Two points are joined by a straight line.

    Parameters
    ----------
    places : x, rising strictly, at least two [-]
    values : y at these places [any]

    Returns
    -------
    dy/dx at every point [unit of y]

    Notes
    -----
    Valid: places that rise strictly.

    References
    ----------
    [FritschButland1984] weighted harmonic mean of the secants, recalled

    Examples
    --------
    >>> slopes = monotone_slopes(places=(0.0, 1.0, 2.0, 4.0), values=(0.0, 0.0, 1.0, 2.0))
    >>> [round(slope, 4) for slope in slopes]
    [0.0, 0.0, 0.6923, 0.1667]
    """
    steps = [right - left for left, right in pairwise(places)]
    secants = [
        (right - left) / step for (left, right), step in zip(pairwise(values), steps, strict=True)
    ]
    if len(secants) == 1:
        return [secants[0], secants[0]]
    inner = []
    for (h1, h2), (d1, d2) in zip(pairwise(steps), pairwise(secants), strict=True):
        alike = real(d1) * real(d2) > 0
        one = 0 * (d1 + d2) + 1.0
        w1, w2 = 2 * h2 + h1, h2 + 2 * h1
        mean = (w1 + w2) / (w1 / where(alike, d1, one) + w2 / where(alike, d2, one))
        inner.append(where(alike, mean, 0.0))
    first = _end_slope(steps[0], steps[1], secants[0], secants[1])
    last = _end_slope(steps[-1], steps[-2], secants[-1], secants[-2])
    return [first, *inner, last]


def _end_slope(h1: Array, h2: Array, d1: Array, d2: Array) -> Array:
    """Slope at an end, from the nearest two steps and their secants."""
    slope = ((2 * h1 + h2) * d1 - h1 * d2) / (h1 + h2)
    slope = where(real(slope) * real(d1) > 0, slope, 0.0)
    turns = real(d1) * real(d2) < 0
    return where(turns & (absolute(real(slope)) > 3 * absolute(real(d1))), 3 * d1, slope)


def curve_value(*, curve: MeteringCurve, share: Array) -> Array:
    """Value of a curve: a cubic between two points, constant beyond the ends.

    y = y0 + t^2 (3 - 2 t) (y1 - y0) + h t (1 - t) [(1 - t) m0 - t m1], t = (x - x0)/h.

    Parameters
    ----------
    curve : places [-], values y and slopes m of its points [any]
    share : x, share of the full signal that opens the edge [-]

    Returns
    -------
    value [unit of the curve's values]

    Notes
    -----
    Valid: places that rise strictly.

    References
    ----------
    [FritschCarlson1980] monotone cubic interpolation

    Examples
    --------
    >>> curve = MeteringCurve.through((0.0, 0.1, 1.0), (0.0, 0.0, 9.0))
    >>> [round(float(curve_value(curve=curve, share=x)), 4) for x in (0.05, 0.1, 0.55, 2.0)]
    [0.0, 0.0, 2.3625, 9.0]
    """
    t, h, y0, rise, m0, m1 = _piece(curve, share)
    return y0 + t * t * (3 - 2 * t) * rise + h * t * (1 - t) * ((1 - t) * m0 - t * m1)


def curve_slope(*, curve: MeteringCurve, share: Array, opens: bool = False) -> Array:
    """Slope of a curve; zero beyond its ends.

    dy/dx = 6 t (1 - t) (y1 - y0)/h + (1 - t) (1 - 3 t) m0 - t (2 - 3 t) m1, t = (x - x0)/h.

    Parameters
    ----------
    curve : places [-], values y and slopes m of the points, in any unit
    share : x, share of the full signal that opens the edge [-]
    opens : whether the first point counts as part of the curve [-]

    Returns
    -------
    slope [unit of the curve's values]

    Notes
    -----
    Valid: places that rise strictly.

    References
    ----------
    [derived] slope of `curve_value`

    Examples
    --------
    >>> curve = MeteringCurve.through((0.0, 1.0), (2.0, 5.0))
    >>> [float(curve_slope(curve=curve, share=x)) for x in (-0.1, 0.5, 1.5)]
    [0.0, 3.0, 0.0]
    """
    t, h, _, rise, m0, m1 = _piece(curve, share)
    slope = 6 * t * (1 - t) * rise / h + (1 - t) * (1 - 3 * t) * m0 - t * (2 - 3 * t) * m1
    first, last = real(curve.places[0]), real(curve.places[-1])
    begun = real(share) >= first if opens else real(share) > first
    return where(begun & (real(share) <= last), slope, 0 * slope)


def _plain(value: Array) -> bool:
    """Whether a value is a number or an array of numbers, real or complex."""
    if isinstance(value, (float, complex, np.number)):
        return True
    return type(value) is np.ndarray and value.dtype.kind in "fc"


def _looked_up(x: Array, places: Array, values: Array, slopes: Array) -> tuple[Array, ...]:
    """The piece of a curve at numbers, by a search in its places."""
    k = np.clip(np.searchsorted(places, real(x), side="right") - 1, 0, len(places) - 2)
    h = places[k + 1] - places[k]
    rise = values[k + 1] - values[k]
    return (x - places[k]) / h, h, values[k], rise, slopes[k], slopes[k + 1]


def _piece(curve: MeteringCurve, share: Array) -> tuple[Array, ...]:
    """Place t within the cubic at a share, its length, first value, rise, and both slopes."""
    x = clip(share, curve.places[0], curve.places[-1])
    table = (curve.places, curve.values, curve.slopes)
    if _plain(x) and all(type(number) is float for row in table for number in row):
        return _looked_up(x, *(np.array(row) for row in table))
    points = list(zip(curve.places, curve.values, curve.slopes, strict=True))
    chosen: tuple[Array, ...] = ()
    for (x0, y0, m0), (x1, y1, m1) in pairwise(points):
        piece = (x0, x1 - x0, y0, y1 - y0, m0, m1)
        if chosen:
            beyond = real(x) >= real(x0)
            piece = tuple(where(beyond, new, old) for new, old in zip(piece, chosen, strict=True))
        chosen = piece
    start, h, y0, rise, m0, m1 = chosen
    return (x - start) / h, h, y0, rise, m0, m1
