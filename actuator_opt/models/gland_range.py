"""Gland over its range of use: hot and cold, with the tolerances of ring and groove."""

from __future__ import annotations

import math

from ..base.numeric import Array, geometry, real, sqrt, where


def volume_ratio(
    *,
    volume_expansion: Array,
    housing_expansion: Array,
    temperature_change: Array,
) -> Array:
    """Ring over groove volume, relative to assembly, (1 + a_V dT)/(1 + a dT)^3.

    The groove fill at temperature is the fill at assembly times this ratio.

    Parameters
    ----------
    volume_expansion : of the rubber a_V [1/K]
    housing_expansion : linear, of the metal around the ring a [1/K]
    temperature_change : since assembly dT [K]

    Returns
    -------
    ratio [-]; 1 at assembly

    Notes
    -----
    Valid: a_V constant over dT; groove and counterface of one linear expansion.

    What the rubber swells or shrinks in the fluid is left out.

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
    squeeze : at assembly C [-]
    volume_ratio : ring over groove volume, relative to assembly r (`volume_ratio`) [-], > 0

    Returns
    -------
    squeeze [-]; <= 0: no contact left; NaN at r <= 0

    Notes
    -----
    Valid: the ring lies on its groove diameter, whose length it follows.

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
    the thinnest ring in the deepest groove on the side the rod moves away from, and the reverse.

    Parameters
    ----------
    squeeze : nominal C [-]
    section : free section W [m]
    section_tolerance : half width t_W [m]
    depth_tolerance : half width of the radial room t_d [m]
    eccentricity : of rod or piston e, at most its radial clearance [m]

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
