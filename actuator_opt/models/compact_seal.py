"""Compact double-acting seals (DAS type): a squeezed elastomer block between guide parts.

The block has the free radial height h and the face width w. It is squeezed by the share C of h
between groove floor and sliding surface, without strain along the circumference. Pressure from
either side energises it, so that one face seals in both directions. Loads are per length of
circumference; the pressure is the difference across the seal, >= 0. Without squeeze (C <= 0) there
is no contact. The peak pressure is `contact_profile.land_peak`.
"""

from __future__ import annotations

import math

from ..base.numeric import Array, geometry, minimum, real, where


def energised_share(*, poissons_ratio: Array) -> Array:
    """Share of the pressure that the block passes on to its face, k = nu/(1 - nu).

    Parameters
    ----------
    poissons_ratio : of the elastomer [-]

    Returns
    -------
    share [-]; 1 for an incompressible elastomer

    Notes
    -----
    Valid: block kept by floor and face; no wall friction (it lowers k away from the pressure).

    References
    ----------
    [derived] Hooke's law with axial stress -p and no strain along radius and circumference

    Examples
    --------
    >>> print(f"{energised_share(poissons_ratio=0.49):.4f}")
    0.9608
    """
    return poissons_ratio / (1 - poissons_ratio)


@geometry
def contact_width(*, squeeze: Array, face_width: Array, groove_width: Array) -> Array:
    """Width of the squeezed face, b = w/(1 - C), at most the groove's width.

    Parameters
    ----------
    squeeze : C, as a share of the free radial height [-]
    face_width : free width w of the sliding face [m]
    groove_width : space between the guide parts [m]

    Returns
    -------
    contact width [m]; 0 without squeeze, NaN at C >= 1

    Notes
    -----
    Valid: oiled block of constant section area, not barrelled.

    References
    ----------
    [derived] constant area in plane strain

    Examples
    --------
    >>> b = contact_width(squeeze=0.12, face_width=8e-3, groove_width=10e-3)
    >>> print(f"{b * 1e3:.4f} mm")
    9.0909 mm
    """
    valid = real(squeeze) < 1
    width = minimum(face_width / where(valid, 1 - squeeze, 1.0), groove_width)
    return where(real(squeeze) > 0, where(valid, width, math.nan), 0.0 * width)


@geometry
def line_load(
    *,
    squeeze: Array,
    face_width: Array,
    youngs_modulus: Array,
    poissons_ratio: Array,
    pressure: Array,
) -> Array:
    """Line load of a squeezed block, f = (E w/3)[(1 - C)^-3 - (1 - C)] + k p w/(1 - C).

    k = nu/(1 - nu). At small squeeze f = (4/3) E C w.

    Parameters
    ----------
    squeeze : C, as a share of the free radial height [-]
    face_width : free width w of the sliding face [m]
    youngs_modulus, poissons_ratio : of the elastomer [Pa], [-]
    pressure : difference across the seal [Pa]

    Returns
    -------
    line load [N/m]; 0 without squeeze, NaN at C >= 1

    Notes
    -----
    Valid: C up to about 0.3, oiled faces (they slip), groove not filled by the squeeze alone.

    References
    ----------
    [Treloar1975] pure shear of rubber; [derived] `energised_share`

    Examples
    --------
    >>> f = line_load(squeeze=0.12, face_width=8e-3, youngs_modulus=9e6,
    ...               poissons_ratio=0.49, pressure=5e6)
    >>> print(f"{f / 1e3:.3f} N/mm")
    57.770 N/mm
    """
    valid = real(squeeze) < 1
    height = where(valid, 1 - squeeze, 1.0)
    block = youngs_modulus / 3 * (1 / (height * height * height) - height)
    share = energised_share(poissons_ratio=poissons_ratio)
    load = face_width * (block + share * pressure / height)
    return where(real(squeeze) > 0, where(valid, load, math.nan), 0.0 * load)
