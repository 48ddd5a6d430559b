"""Gland of an O-ring: squeeze, stretch and fill, their extremes in use, and the extrusion gap.

C is the squeeze as a share of the free section W. The extremes cover temperature and the
tolerances of ring and groove. The largest extrusion gap follows from a table of the seal's maker,
passed as an argument: a row per hardness, with points of pressure and gap.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import TypeAlias

from ..base.numeric import Array, geometry, maximum, minimum, namespace, real, sqrt, where

WIDTH_RATIO = 1.3655
"""Ratio of groove width to free section: least squares through the origin on the five tabulated
reciprocating glands (mid-tolerance widths 2.4255, 3.6195, 4.8135, 7.2005, 9.5885 mm at sections
1.778, 2.616, 3.531, 5.334, 6.985 mm); largest residual 0.083 mm (at 5.334 mm)."""


@geometry
def squeeze_after(*, squeeze: Array, section: Array, growth: Array, tolerance: Array) -> Array:
    """Squeeze left after bore growth and gland tolerance, C = C0 - (u + tol)/W.

    Parameters
    ----------
    squeeze : at assembly, as a share of the free section [-]
    section : free section W [m]
    growth : radial bore growth at the seal [m]
    tolerance : radial gland tolerance to the loose side [m]

    Returns
    -------
    squeeze [-]; <= 0: no contact left

    Notes
    -----
    Valid: radial gland, unstretched section.

    References
    ----------
    [ElAsswad2018] section 4.2, where h depends on the growth of the bore

    Examples
    --------
    >>> print(f"{squeeze_after(squeeze=0.15, section=2e-3, growth=3e-5, tolerance=5e-5):.3f}")
    0.110
    """
    return squeeze - (growth + tolerance) / section


@geometry
def stretched_section(*, section: Array, stretch: Array) -> Array:
    """Section of a stretched ring, W' = W/sqrt(1 + e), at constant volume.

    Parameters
    ----------
    section : free section W [m]
    stretch : circumferential strain of the ring in place [-], > -1

    Returns
    -------
    section in place [m]

    Notes
    -----
    Valid: stretch up to about 0.25; NaN at stretch <= -1.

    References
    ----------
    [derived] incompressible torus: W'^2 (1 + e) = W^2

    Examples
    --------
    >>> print(f"{stretched_section(section=3.53e-3, stretch=0.05) * 1e3:.4f} mm")
    3.4449 mm
    """
    valid = real(stretch) > -1
    safe = where(valid, 1 + stretch, 1.0)
    return where(valid, section / namespace(safe).sqrt(safe), math.nan)


@geometry
def gland_depth(*, squeeze: Array, section: Array) -> Array:
    """Radial space for the ring, gland depth = W (1 - C).

    Parameters
    ----------
    squeeze : as a share of the free section [-]
    section : free section W [m]

    Returns
    -------
    depth [m]

    Notes
    -----
    Valid: unstretched section.

    References
    ----------
    [derived] definition of the squeeze

    Examples
    --------
    >>> print(f"{gland_depth(squeeze=0.13, section=3.53e-3) * 1e3:.3f} mm")
    3.071 mm
    """
    return section * (1 - squeeze)


@geometry
def gland_fill(*, section: Array, groove_width: Array, gland_depth: Array) -> Array:
    """Share of the groove that the ring fills, (pi W^2/4)/(width depth).

    Parameters
    ----------
    section : section in place (`stretched_section`) [m]
    groove_width, gland_depth : [m]

    Returns
    -------
    share of the groove [-]; above about 0.85 swell and heat can overfill it

    Notes
    -----
    Valid: rectangular groove.

    References
    ----------
    [derived] section over groove area

    Examples
    --------
    >>> print(f"{gland_fill(section=3.53e-3, groove_width=4.2e-3, gland_depth=3.1e-3):.3f}")
    0.752
    """
    return (0.25 * math.pi) * section * section / (groove_width * gland_depth)


@geometry
def extrusion_gap(*, clearance: Array, growth: Array) -> Array:
    """Radial gap behind the ring, clearance plus bore growth at the seal.

    Parameters
    ----------
    clearance : radial [m]; pass twice this value where a side load pushes the piston to one side
    growth : radial bore growth at the seal [m]

    Returns
    -------
    gap [m]

    Notes
    -----
    Valid: everywhere.

    References
    ----------
    [derived] concentric piston in the grown bore

    Examples
    --------
    >>> print(f"{extrusion_gap(clearance=30e-6, growth=19e-6) * 1e6:.0f} um")
    49 um
    """
    return clearance + growth


@geometry
def limited_width(*, contact_width: Array, groove_width: Array) -> Array:
    """Contact width, limited to the width of the groove.

    Parameters
    ----------
    contact_width, groove_width : [m]

    Returns
    -------
    contact width [m]

    Notes
    -----
    Valid: everywhere.

    References
    ----------
    [derived] the ring cannot leave its groove

    Examples
    --------
    >>> limited_width(contact_width=3e-3, groove_width=2.6e-3)
    0.0026
    """
    return minimum(contact_width, groove_width)


@geometry
def groove_width(*, section: Array) -> Array:
    """Default groove width of a reciprocating O-ring without back-up ring, g = 1.3655 W.

    Parameters
    ----------
    section : free section W [m]

    Returns
    -------
    groove width [m]; NaN at W <= 0

    Notes
    -----
    Valid: W 1.78 to 6.99 mm, within 0.09 mm of the tabulated mid-tolerance width.

    Metric practice is narrower (about 1.2 W) and fills the groove more.

    References
    ----------
    [EngineersEdgeGlands] reciprocating glands of AS568 sections; [derived] fit through the table

    Examples
    --------
    >>> print(f"{groove_width(section=3.531e-3) * 1e3:.2f} mm")
    4.82 mm
    """
    return where(real(section) > 0, WIDTH_RATIO * section, 0 * section + float("nan"))


@geometry
def back_up_groove_width(*, groove_width: Array, thickness: Array, count: Array) -> Array:
    """Groove width with back-up rings, g + n t.

    Parameters
    ----------
    groove_width : for the ring alone, g [m]
    thickness : axial, of one back-up ring with its play, t [m]
    count : number of back-up rings, n [-]

    Returns
    -------
    groove width [m]

    Notes
    -----
    Valid: rectangular groove, back-up rings beside the ring.

    References
    ----------
    [derived] lengths added up

    Examples
    --------
    >>> width = back_up_groove_width(groove_width=4.8e-3, thickness=1.4e-3, count=2)
    >>> print(f"{width * 1e3:.1f} mm")
    7.6 mm
    """
    return groove_width + count * thickness


def volume_ratio(
    *,
    volume_expansion: Array,
    housing_expansion: Array,
    temperature_change: Array,
) -> Array:
    """Ratio of ring to groove volume, relative to assembly, (1 + a_V dT)/(1 + a dT)^3.

    The groove fill at temperature is the fill at assembly times this ratio.

    Parameters
    ----------
    volume_expansion : of the rubber, a_V [1/K]
    housing_expansion : linear, of the metal around the ring, a [1/K]
    temperature_change : since assembly, dT [K]

    Returns
    -------
    ratio [-]; 1 at assembly

    Notes
    -----
    Valid: a_V constant over dT; groove and counterface have the same linear expansion.

    Swelling and shrinkage of the rubber in the fluid are left out.

    References
    ----------
    [derived] volumes of ring and groove, each at its own expansion

    Examples
    --------
    >>> hot = volume_ratio(volume_expansion=6.6e-4, housing_expansion=11.5e-6,
    ...                    temperature_change=60.0)
    >>> print(f"{hot:.4f}")
    1.0375
    """
    ring = 1 + volume_expansion * temperature_change
    side = 1 + housing_expansion * temperature_change
    return ring / (side * side * side)


def squeeze_at_volume(*, squeeze: Array, volume_ratio: Array) -> Array:
    """Squeeze of a ring that grew or shrank in its groove, C' = 1 - (1 - C)/sqrt(r).

    Parameters
    ----------
    squeeze : at assembly, C [-]
    volume_ratio : r, ring volume / groove volume, relative to assembly (`volume_ratio`) [-], > 0

    Returns
    -------
    squeeze [-]; <= 0: no contact left; NaN at r <= 0

    Notes
    -----
    Valid: the ring stays on the groove's diameter, and only its section grows or shrinks.

    References
    ----------
    [derived] section of constant length, W'^2 = r W^2 beside the depth of the groove

    Examples
    --------
    >>> print(f"{squeeze_at_volume(squeeze=0.13, volume_ratio=0.96):.4f}")
    0.1121
    """
    valid = real(volume_ratio) > 0
    root = sqrt(where(valid, volume_ratio, 0 * volume_ratio + 1))
    return where(valid, 1 - (1 - squeeze) / root, 0 * (squeeze + volume_ratio) + math.nan)


@geometry
def squeeze_extremes(
    *,
    squeeze: Array,
    section: Array,
    section_tolerance: Array,
    depth_tolerance: Array,
    eccentricity: Array,
) -> tuple[Array, Array]:
    """Loosest and tightest squeeze of a tolerance stack.

    Loosest 1 - (d + t_d + e)/(W - t_W), tightest 1 - (d - t_d - e)/(W + t_W), d = W (1 - C):
    the thinnest ring in the deepest groove on the side that the rod moves away from; and the
    thickest ring in the shallowest groove on the opposite side.

    Parameters
    ----------
    squeeze : nominal, C [-]
    section : free section W [m]
    section_tolerance : half the tolerance width of the section, t_W [m]
    depth_tolerance : half the tolerance width of the radial space, t_d [m]
    eccentricity : of rod or piston, e; at most its radial clearance [m]

    Returns
    -------
    loosest, tightest squeeze [-]

    Notes
    -----
    Valid: t_W < W; unstretched section.

    References
    ----------
    [derived] the limits of size added up without statistics

    Examples
    --------
    >>> ring = {"section": 3.531e-3, "section_tolerance": 0.102e-3}
    >>> loose, tight = squeeze_extremes(squeeze=0.1225, depth_tolerance=0.0255e-3,
    ...                                 eccentricity=0.03e-3, **ring)
    >>> print(f"{loose:.3f} {tight:.3f}")
    0.080 0.162
    """
    depth = section * (1 - squeeze)
    loosest = 1 - (depth + depth_tolerance + eccentricity) / (section - section_tolerance)
    tightest = 1 - (depth - depth_tolerance - eccentricity) / (section + section_tolerance)
    return loosest, tightest


Points: TypeAlias = Sequence[tuple[Array, Array]]
"""Pairs of pressure [Pa] and largest gap [m], in the order of rising pressure."""


Table: TypeAlias = Sequence[tuple[Array, Points]]
"""Rows in the order of rising hardness: a hardness [Shore A] with its pairs of pressure and gap."""


ROUNDING = 1e-9
"""Share by which a pressure may exceed a table's last pressure and still count as equal to it."""


def gap_limit(*, pressure: Array, points: Points) -> Array:
    """Largest permitted gap g at a pressure: ln g is linear between the points, constant beyond.

    Parameters
    ----------
    pressure : difference across the seal [Pa]
    points : pressure [Pa] and largest gap [m] of a compound or of a back-up ring, pressure rising

    Returns
    -------
    radial gap [m]

    Notes
    -----
    Valid: up to the last point; below the first point, the constant value is on the safe side.

    `backed_gap_limit` chooses between the limits of a seal and of its back-up ring.

    References
    ----------
    [SealAndDesignExtrusion] form of the table; [derived] interpolation in ln g is never above a
    straight line in g

    Examples
    --------
    >>> points = ((68.9e5, 0.127e-3), (103.4e5, 0.0762e-3))
    >>> print(f"{gap_limit(pressure=86.15e5, points=points) * 1e3:.4f} mm")
    0.0984 mm
    """
    return _exp(_log_gap(pressure, points))


def extrusion_gap_limit(*, hardness: Array, pressure: Array, table: Table) -> Array:
    """Largest permitted gap at a hardness and a pressure: ln g is linear in both inside the table.

    Beyond the table the gap is constant.

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

    It is the lower of the last pressures of the two rows with the nearest hardnesses. For a seal
    harder than the last row, it is the last pressure of that row.

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

    A back-up ring bridges the gap for the seal, so the larger of both limits counts. Above the last
    pressure of its data, a limit is only continued as a constant and does not count: the limit
    whose data reach higher counts alone, even above the end of its own data.

    Parameters
    ----------
    pressure : difference across the seal [Pa]
    seal_limit, ring_limit : radial gaps that the seal alone and the back-up ring bear [m]
    seal_end, ring_end : pressures up to which these limits are stated [Pa]

    Returns
    -------
    radial gap [m]; it steps down where the data of the larger limit end

    Notes
    -----
    Valid: where p is at most the larger of the two ends.

    References
    ----------
    [SealAndDesignExtrusion] clearances up to each pressure without a back-up ring; [derived] no
    limit is known beyond the last pressure of its data

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
    """Piecewise linear interpolation, constant beyond both ends."""
    result = points[0][1] + 0 * x
    for (x0, y0), (x1, y1) in pairwise(points):
        result = where(real(x) > real(x0), y0 + (y1 - y0) / (x1 - x0) * (x - x0), result)
    last, end = points[-1]
    return where(real(x) >= real(last), end + 0 * x, result)
