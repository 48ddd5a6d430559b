"""Spool whose four edges have lap, clearance and width of their own.

The spool is at x = s U/U_max, with stroke s, at most s from its centre. It uncovers the edges P-A
and B-T by x - o and the edges A-T and P-B by -x - o, where o is the overlap of each edge.
"""

from __future__ import annotations

from itertools import pairwise

from ..base.dataclass import dataclass
from ..base.numeric import Array, absolute, clip, maximum, positive, real, where
from .lapped_edge import lapped_edge_conductance, lapped_edge_flow, lapped_edge_gain
from .orifice import TURBULENT_COEFFICIENT

CLEAR = 4.0
"""Uncovered length at which an edge with clearance counts as open, in clearances. Our choice: the
opening is then 3 % larger than the uncovered length."""
NULL = 0.01
"""Least uncovered length at which an edge with clearance counts as open, as a share of the stroke.
Our choice: closer to the edge, viscous flow lowers the flow gain."""


@dataclass(frozen=True, slots=True)
class SpoolEdge:
    """One metering edge; see `lapped_edge.lapped_edge_flow`."""

    overlap: Array
    """[m]; negative: open at the centre."""
    area_gradient: Array
    """Width of the ports around the spool [m]."""
    clearance: Array | None = None
    """Radial [m]; None: the edge does not leak."""
    rounding: Array = 0.0
    """Radius of the corners [m]."""


@dataclass(frozen=True, slots=True)
class LappedSpool:
    """A spool with its four edges, and the oil in them."""

    supply_a: SpoolEdge
    supply_b: SpoolEdge
    a_tank: SpoolEdge
    b_tank: SpoolEdge
    stroke: Array
    """Largest distance from the centre [m], > 0."""
    full_signal: Array
    """Signal at the full stroke [V], > 0."""
    density: Array
    dynamic_viscosity: Array
    flow_coefficient: Array = TURBULENT_COEFFICIENT
    curve: tuple[tuple[Array, Array], ...] = ()
    """Points between 0 and 1: share of the full signal, and share of the stroke there."""

    def start(self, edge: SpoolEdge) -> Array:
        """Stroke at which an edge counts as open [m]."""
        return edge.overlap if edge.clearance is None else self.opened(edge)

    def signal_share(self, stroke: float) -> float:
        """Largest share of the full signal at which the spool is no farther than a stroke [m]."""
        share = min(stroke / float(self.stroke), 1.0)
        for start, x, _, slope in reversed(_segments(self)):
            if float(slope) > 0 and float(x) <= share:
                return float(start) + (share - float(x)) / float(slope)
        return 0.0

    def position(self, signal: Array) -> Array:
        """Position of the spool at a signal [m]; see `spool_stroke`."""
        return spool_stroke(spool=self, signal=signal)

    def position_slope(self, place: Array) -> Array:
        """Slope of the position over the signal [m/V]; see `stroke_slope`."""
        return stroke_slope(spool=self, place=place)

    def edge_flow(self, edge: SpoolEdge, place: Array, drop: Array) -> Array:
        """Flow through an edge, with the spool moved by `place` to open it [m^3/s]."""
        return lapped_edge_flow(pressure_drop=drop, **self._law(edge, place))

    def edge_gain(
        self, edge: SpoolEdge, place: Array, drop: Array, *, opens: bool = False
    ) -> Array:
        """Slope of that flow over the place [m^3/s/m]; `opens`: the edge is about to open."""
        return lapped_edge_gain(pressure_drop=drop, opens=opens, **self._law(edge, place))

    def edge_conductance(self, edge: SpoolEdge, place: Array, drop: Array) -> Array:
        """Slope of that flow over the pressure drop [m^3/s/Pa]."""
        return lapped_edge_conductance(pressure_drop=drop, **self._law(edge, place))

    def _law(self, edge: SpoolEdge, place: Array) -> dict[str, Array]:
        """Arguments of the functions of an edge, with the spool moved by `place` to open it."""
        return {
            "uncovered": place - edge.overlap,
            "area_gradient": edge.area_gradient,
            "clearance": edge.clearance,
            "rounding": edge.rounding,
            "density": self.density,
            "dynamic_viscosity": self.dynamic_viscosity,
            "flow_coefficient": self.flow_coefficient,
        }

    def opened(self, edge: SpoolEdge) -> Array:
        """Stroke at which an edge is open beyond its lap and clearance [m]."""
        clear = 0.0 if edge.clearance is None else CLEAR * edge.clearance
        return edge.overlap + maximum(clear, NULL * self.stroke)


def spool_stroke(*, spool: LappedSpool, signal: Array) -> Array:
    """Position of the spool at a signal, x = s f(U/U_max), at most s from its centre.

    Without curve f(u) = u; else the points of the curve are joined by straight lines, and the other
    direction is its mirror image.

    Parameters
    ----------
    spool : stroke s [m] and signal U_max at full stroke [V]
    signal : U, either sign [V]

    Returns
    -------
    position [m]; NaN where the full signal is not positive

    Notes
    -----
    Valid: a spool that follows its signal without delay.

    References
    ----------
    [derived] spool with mechanical stops

    Examples
    --------
    >>> edge = SpoolEdge(overlap=0.0, area_gradient=20e-3)
    >>> spool = LappedSpool(edge, edge, edge, edge, 1e-3, 10.0, 870.0, 0.03)
    >>> [float(spool_stroke(spool=spool, signal=u)) for u in (-2.5, 12.0)]
    [-0.00025, 0.001]
    """
    if not spool.curve:
        x = spool.stroke * signal / positive(spool.full_signal)
        return clip(x, -spool.stroke, spool.stroke)
    share = signal / positive(spool.full_signal)
    size, travel = absolute(share), 0.0
    for start, _, end, slope in _segments(spool):
        travel = travel + slope * (clip(size, start, end) - start)
    x = spool.stroke * travel
    return where(real(share) >= 0, x, -x)


def _segments(spool: LappedSpool) -> list[tuple[Array, Array, Array, Array]]:
    """Straight parts of the curve: signal and stroke at the start, signal at the end, slope."""
    points = [(0.0, 0.0), *spool.curve, (1.0, 1.0)]
    return [
        (u, x, u_next, (x_next - x) / (u_next - u)) for (u, x), (u_next, x_next) in pairwise(points)
    ]


def stroke_slope(*, spool: LappedSpool, place: Array) -> Array:
    """Slope of the spool's position over its signal at a position, dx/dU.

    Parameters
    ----------
    spool : stroke s [m], signal U_max at full stroke [V] and curve
    place : position x of the spool, either sign [m]

    Returns
    -------
    slope [m/V]; at a point of the curve, that of the part beyond it

    Notes
    -----
    Valid: within the stroke.

    References
    ----------
    [derived] slope of `spool_stroke`

    Examples
    --------
    >>> edge = SpoolEdge(overlap=0.0, area_gradient=20e-3)
    >>> spool = LappedSpool(edge, edge, edge, edge, 1e-3, 10.0, 870.0, 0.03, curve=((0.5, 0.2),))
    >>> [round(float(stroke_slope(spool=spool, place=x)) * 1e6) for x in (1e-4, -5e-4)]
    [40, 160]
    """
    per_volt = spool.stroke / positive(spool.full_signal)
    slope: Array = 1.0
    for i, (_, x, _, steepness) in enumerate(_segments(spool) if spool.curve else ()):
        beyond = real(absolute(place)) >= real(x * spool.stroke)
        slope = where(beyond, steepness, slope) if i else steepness
    return slope * per_volt + 0 * place
