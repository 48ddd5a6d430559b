"""Largest extrusion gap of a seal over pressure and hardness.

A table of limits is an argument: rows of a hardness with points of pressure and gap, from the maker
of the seal. The gap is radial, half the diametral clearance of a centred piston.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import TypeAlias

from ..base.numeric import Array, maximum, minimum, namespace, real, where

Points: TypeAlias = Sequence[tuple[Array, Array]]
"""Points of pressure [Pa] and gap [m], pressure rising."""
Table: TypeAlias = Sequence[tuple[Array, Points]]
"""Rows of hardness [Shore A] and its points, hardness rising."""

ROUNDING = 1e-9
"""Relative excess of a pressure that is no excess."""


def gap_limit(*, pressure: Array, points: Points) -> Array:
    """Largest gap at a pressure, ln g linear in p between the points, held beyond them.

    Parameters
    ----------
    pressure : difference across the seal [Pa]
    points : pressure [Pa] and largest gap [m] of a compound or of a back-up ring, pressure rising

    Returns
    -------
    radial gap [m]

    Notes
    -----
    Valid: up to the last point; below the first the held value is on the safe side.

    What counts of a seal and its back-up ring says `backed_gap_limit`.

    References
    ----------
    [SealAndDesignExtrusion] form of the table; [derived] ln g is never above a straight line in g

    Examples
    --------
    >>> points = ((68.9e5, 0.127e-3), (103.4e5, 0.0762e-3))
    >>> print(f"{gap_limit(pressure=86.15e5, points=points) * 1e3:.4f} mm")
    0.0984 mm
    """
    return _exp(_log_gap(pressure, points))


def extrusion_gap_limit(*, hardness: Array, pressure: Array, table: Table) -> Array:
    """Largest gap at a hardness and a pressure, ln g linear in both, held beyond the table.

    Parameters
    ----------
    hardness : of the seal [Shore A]
    pressure : difference across the seal [Pa]
    table : rows of hardness [Shore A] with points of pressure [Pa] and gap [m], both rising

    Returns
    -------
    radial gap [m]

    Notes
    -----
    Valid: where p is at most `extrusion_pressure_end`; no back-up ring.

    A seal harder than the last row has that row's gap, which is on the safe side.

    References
    ----------
    [SealAndDesignExtrusion] form of the table; [derived] interpolation between two hardnesses

    Examples
    --------
    >>> table = ((70.0, ((68.9e5, 0.127e-3), (103.4e5, 0.0762e-3))),
    ...          (90.0, ((68.9e5, 0.305e-3), (103.4e5, 0.254e-3))))
    >>> print(f"{extrusion_gap_limit(hardness=80.0, pressure=68.9e5, table=table) * 1e3:.4f} mm")
    0.1968 mm
    """
    rows = [(row, _log_gap(pressure, points)) for row, points in table]
    return _exp(_held(hardness, rows))


def extrusion_pressure_end(*, hardness: Array, table: Table) -> Array:
    """Highest pressure that a table of extrusion limits covers at a hardness.

    The lower end of the two rows beside the hardness; that of the last row for a harder seal.

    Parameters
    ----------
    hardness : of the seal [Shore A]
    table : rows of hardness [Shore A] with points of pressure [Pa] and gap [m], both rising

    Returns
    -------
    pressure [Pa]; 0 for a seal softer than the first row: the table does not cover it

    Notes
    -----
    Valid: any table; beyond the pressure a back-up ring or another table is needed.

    References
    ----------
    [derived] an interpolated limit needs both of its rows

    Examples
    --------
    >>> table = ((70.0, ((35e5, 0.25e-3), (140e5, 0.05e-3))),
    ...          (90.0, ((35e5, 0.4e-3), (350e5, 0.08e-3))))
    >>> [float(extrusion_pressure_end(hardness=h, table=table)) / 1e5 for h in (60.0, 80.0, 95.0)]
    [0.0, 140.0, 350.0]
    """
    ends = [(row, points[-1][0]) for row, points in table]
    result = 0 * hardness
    for (row, end), (following, next_end) in pairwise(ends):
        result = where(real(hardness) >= real(row), end + 0 * hardness, result)
        inside = (real(hardness) > real(row)) & (real(hardness) < real(following))
        result = where(inside, minimum(end, next_end) + 0 * hardness, result)
    last, end = ends[-1]
    return where(real(hardness) >= real(last), end + 0 * hardness, result)


def backed_gap_limit(
    *, pressure: Array, seal_limit: Array, seal_end: Array, ring_limit: Array, ring_end: Array
) -> Array:
    """Largest gap with a back-up ring: the larger limit of those that cover the pressure.

    A back-up ring bridges the gap for the seal, so that the seal's own limit is no bound while the
    ring bears more, nor the ring's while the seal needs none. Beyond the pressure to which a limit
    was stated it is held, not known, and tells nothing of a gap that may be larger: the other one
    counts alone, and beyond both the one stated to the higher pressure.

    Parameters
    ----------
    pressure : difference across the seal [Pa]
    seal_limit, ring_limit : radial gaps that the seal alone and the back-up ring bear [m]
    seal_end, ring_end : pressures up to which they are stated [Pa]

    Returns
    -------
    radial gap [m]; it steps down where the larger of two limits ends

    Notes
    -----
    Valid: where p is at most the larger of the two ends.

    References
    ----------
    [SealAndDesignExtrusion] clearances up to each pressure without a back-up ring; [derived] a
    limit beyond its last pressure is no statement

    Examples
    --------
    >>> known = {"seal_limit": 0.127, "seal_end": 206.8, "ring_limit": 0.076, "ring_end": 345.0}
    >>> [backed_gap_limit(pressure=p, **known) for p in (200.0, 210.0, 400.0)]
    [0.127, 0.076, 0.076]
    """
    larger = maximum(seal_limit, ring_limit)
    farther = where(real(ring_end) > real(seal_end), ring_limit, seal_limit)
    ends = minimum(real(seal_end), real(ring_end))
    found = where(real(pressure) > ends * (1 + ROUNDING), farther, larger)
    return found + 0 * pressure


def _log_gap(pressure: Array, points: Points) -> Array:
    xp = namespace(*(gap for _, gap in points), pressure)
    return _held(pressure, [(at, xp.log(gap)) for at, gap in points])


def _exp(value: Array) -> Array:
    return namespace(value).exp(value)


def _held(x: Array, points: Sequence[tuple[Array, Array]]) -> Array:
    """Piecewise linear interpolation, held at both ends."""
    result = points[0][1] + 0 * x
    for (x0, y0), (x1, y1) in pairwise(points):
        result = where(real(x) > real(x0), y0 + (y1 - y0) / (x1 - x0) * (x - x0), result)
    last, end = points[-1]
    return where(real(x) >= real(last), end + 0 * x, result)
