"""Wear of seals, as far as it can be estimated without a wear test."""

from __future__ import annotations

from ..base.numeric import Array, geometry, real, where


@geometry
def sliding_severity(*, line_load: Array, contact_width: Array, distance: Array) -> Array:
    """Mean contact pressure times sliding distance, (f/b) L: proportional to the depth worn.

    The worn depth is k (f/b) L with the wear rate k of the material pair. Only a test gives k, so
    the severity only compares designs with the same pair of materials.

    Parameters
    ----------
    line_load : normal force per length of circumference f [N/m]
    contact_width : b [m]
    distance : sliding distance L [m]

    Returns
    -------
    severity [Pa m]; 0 without contact

    Notes
    -----
    Valid: dry or boundary contact; with an oil film there is less wear.

    References
    ----------
    [Archard1953] volume worn proportional to load and distance

    Examples
    --------
    >>> s = sliding_severity(line_load=8e3, contact_width=1e-3, distance=0.22)
    >>> print(f"{s / 1e3:.0f} N/mm")
    1760 N/mm
    """
    touching = real(contact_width) > 0
    return where(touching, distance * line_load / where(touching, contact_width, 1.0), 0.0)
