"""Gland geometry of an O-ring: squeeze, stretch, fill and the gap behind it.

C is the squeeze over the free section W. `seals` re-exports these functions.
"""

from __future__ import annotations

import math

from ..numeric import Array, minimum, namespace, real, where


def squeeze_after(*, squeeze: Array, section: Array, growth: Array, tolerance: Array) -> Array:
    """Squeeze left after bore growth and gland tolerance, C = C0 - (u + tol)/W.

    Parameters
    ----------
    squeeze : at assembly, of the free section, -
    section : free section W, m
    growth : radial bore growth at the seal, m
    tolerance : radial gland tolerance to the loose side, m

    Returns
    -------
    -; <= 0: no contact left

    Valid: radial gland, unstretched section.

    Examples
    --------
    >>> print(f"{squeeze_after(squeeze=0.15, section=2e-3, growth=3e-5, tolerance=5e-5):.3f}")
    0.110

    References
    ----------
    [ElAsswad2018] section 4.2 (h depends on the growth of the bore); [derived]
    """
    return squeeze - (growth + tolerance) / section


def stretched_section(*, section: Array, stretch: Array) -> Array:
    """Section of a stretched ring, W' = W/sqrt(1 + e), at constant volume.

    Parameters
    ----------
    section : free section W, m
    stretch : circumferential strain of the ring in place, > -1

    Returns
    -------
    m

    Valid: stretch up to about 0.25; NaN at stretch <= -1.

    Examples
    --------
    >>> print(f"{stretched_section(section=3.53e-3, stretch=0.05) * 1e3:.4f} mm")
    3.4449 mm

    References
    ----------
    [derived] incompressible torus: W'^2 (1 + e) = W^2
    """
    valid = real(stretch) > -1
    safe = where(valid, 1 + stretch, 1.0)
    return where(valid, section / namespace(safe).sqrt(safe), math.nan)


def gland_depth(*, squeeze: Array, section: Array) -> Array:
    """Radial room of the ring, gland depth = W (1 - C).

    Parameters
    ----------
    squeeze : of the free section, -
    section : free section W, m

    Returns
    -------
    m

    Valid: unstretched section.

    Examples
    --------
    >>> print(f"{gland_depth(squeeze=0.13, section=3.53e-3) * 1e3:.3f} mm")
    3.071 mm

    References
    ----------
    [derived] definition of the squeeze
    """
    return section * (1 - squeeze)


def squeeze_in_place(
    *, squeeze: Array, section: Array, stretch: Array, growth: Array, tolerance: Array
) -> Array:
    """Squeeze of the stretched section in its gland, (W' - depth)/W'.

    Depth = W (1 - C0) + growth + tolerance, W' from `stretched_section`.

    Parameters
    ----------
    squeeze : at assembly, of the free section, -
    section : free section W, m
    stretch : circumferential strain in place, -
    growth : radial bore growth at the seal, m
    tolerance : radial gland tolerance, > 0 to the loose side, m

    Returns
    -------
    -; <= 0: no contact left

    Valid: radial gland, stretch up to about 0.25.

    Examples
    --------
    >>> c = squeeze_in_place(squeeze=0.15, section=2e-3, stretch=0.02, growth=3e-5, tolerance=5e-5)
    >>> print(f"{c:.4f}")
    0.1011

    References
    ----------
    [derived] constant ring volume, gland at its worst
    """
    thin = stretched_section(section=section, stretch=stretch)
    depth = gland_depth(squeeze=squeeze, section=section) + growth + tolerance
    return 1 - depth / thin


def gland_fill(*, section: Array, groove_width: Array, gland_depth: Array) -> Array:
    """Share of the groove the ring fills, (pi W^2/4)/(width depth).

    Parameters
    ----------
    section : section in place (`stretched_section`), m
    groove_width, gland_depth : m

    Returns
    -------
    -; above about 0.85 swell and heat can overfill the groove

    Valid: rectangular groove.

    Examples
    --------
    >>> print(f"{gland_fill(section=3.53e-3, groove_width=4.2e-3, gland_depth=3.1e-3):.3f}")
    0.752

    References
    ----------
    [derived] areas
    """
    return (0.25 * math.pi) * section * section / (groove_width * gland_depth)


def extrusion_gap(*, clearance: Array, growth: Array) -> Array:
    """Radial gap behind the ring, clearance plus bore growth at the seal.

    Parameters
    ----------
    clearance : radial, m (twice it when side load pushes the piston over)
    growth : radial bore growth at the seal, m

    Returns
    -------
    m

    Valid: everywhere.

    Examples
    --------
    >>> print(f"{extrusion_gap(clearance=30e-6, growth=19e-6) * 1e6:.0f} um")
    49 um

    References
    ----------
    [derived] concentric piston in the grown bore
    """
    return clearance + growth


def limited_width(*, contact_width: Array, groove_width: Array) -> Array:
    """Contact width no wider than the groove.

    Parameters
    ----------
    contact_width, groove_width : m

    Returns
    -------
    m

    Valid: everywhere.

    Examples
    --------
    >>> limited_width(contact_width=3e-3, groove_width=2.6e-3)
    0.0026

    References
    ----------
    [derived] the ring cannot leave its groove
    """
    return minimum(contact_width, groove_width)
