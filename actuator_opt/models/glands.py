"""Standard O-ring glands as smooth functions of the ring's section."""

from __future__ import annotations

from ..numeric import Array, real, where

WIDTH_RATIO = 1.3655
"""Groove width over free section: least squares through the origin on the five tabulated
reciprocating glands (mid-tolerance widths 2.4255, 3.6195, 4.8135, 7.2005, 9.5885 mm at sections
1.778, 2.616, 3.531, 5.334, 6.985 mm); largest residual 0.083 mm (at 5.334 mm)."""


def groove_width(*, section: Array) -> Array:
    """Default groove width of a reciprocating O-ring without back-up ring, g = 1.3655 W.

    Parameters
    ----------
    section : free section W, m

    Returns
    -------
    m; NaN at W <= 0

    Valid: W 1.78 to 6.99 mm, within 0.09 mm of the tabulated mid-tolerance width. Metric practice
    is narrower (about 1.2 W) and fills the groove more.

    Examples
    --------
    >>> print(f"{groove_width(section=3.531e-3) * 1e3:.2f} mm")
    4.82 mm

    References
    ----------
    [EngineersEdgeGlands] reciprocating glands of AS568 sections; [derived] fit through the table
    """
    return where(real(section) > 0, WIDTH_RATIO * section, 0 * section + float("nan"))
