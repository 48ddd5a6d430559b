"""Friction of oscillating flow in a round line: the series impedance by name of the friction.

`lossless`     none
`steady`       the laminar resistance of steady flow, at every frequency
`distributed`  laminar flow whose profile follows the frequency [DSouza1964]
"""

from __future__ import annotations

import math
from typing import Any

from ..base.numeric import Array, geometry, namespace, where

FRICTION = ("lossless", "steady", "distributed")
_LEVELS = 28
"""Levels of the continued fraction; both forms then err by less than 1e-10 of the value."""
_NEAR = 20.0
"""Largest |r sqrt(i omega/nu)| of the continued fraction; the asymptotic series beyond."""
_SERIES = (-1 / 2, -1 / 8, -1 / 8, -25 / 128, -13 / 32, -1073 / 1024, -103 / 32)
"""I1(w)/I0(w) = 1 - 1/(2 w) - ... for large w."""


@geometry
def series_impedance(
    *,
    frequency: Array,
    inner_diameter: Array,
    density: Array,
    dynamic_viscosity: Array,
    friction: str = "distributed",
) -> Array:
    """Series impedance of a line per length, R' + i omega L' at a frequency.

    `lossless` i omega rho/A; `steady` 128 eta/(pi d^4) + i omega rho/A; `distributed`
    (i omega rho/A)/(1 - 2 I1(w)/(w I0(w))), w = r sqrt(i omega/nu), which tends to
    128 eta/(pi d^4) + (4/3) i omega rho/A at low and to (i omega rho/A)(1 + 2/w) at high
    frequency. Its Bessel functions are evaluated as a continued fraction and a series.

    Parameters
    ----------
    frequency : [Hz]
    inner_diameter : [m]
    density : [kg/m^3]
    dynamic_viscosity : [Pa s]; > 0 for `distributed`
    friction : name of the friction [-]

    Returns
    -------
    complex impedance per length [Pa s/m^4]

    Raises
    ------
    ValueError
        An unknown friction.

    Notes
    -----
    Valid: laminar flow about a mean flow that is laminar too; isothermal; rigid section.

    References
    ----------
    [DSouza1964] frequency-dependent friction; [AaltoThesis] eq. 12, 14 for `steady`

    Examples
    --------
    >>> z = series_impedance(frequency=0.0, inner_diameter=8e-3, density=865.0,
    ...                      dynamic_viscosity=0.04)
    >>> print(f"{z.real * 1.2:.5e}")
    4.77465e+08
    """
    if friction not in FRICTION:
        raise ValueError(f"friction: {friction}; choose one of {', '.join(FRICTION)}")
    xp = namespace(frequency, inner_diameter, density, dynamic_viscosity)
    radius_square = 0.25 * inner_diameter * inner_diameter
    area = math.pi * radius_square
    rate = 2j * math.pi * xp.asarray(frequency, dtype=xp.complex128)
    inertia = rate * density / area
    if friction == "lossless":
        return inertia
    scale = dynamic_viscosity / (area * radius_square)
    if friction == "steady":
        return inertia + 8 * scale
    return scale * _profile(xp, inertia / scale)


def _profile(xp: Any, square: Array) -> Array:
    """w^2/(1 - 2 I1(w)/(w I0(w))) of w^2: 8 + 4 w^2/3 for small, w^2 + 2 w + ... for large w.

    With x_n = I_n/(w I_(n-1)) = 1/(2 n + w^2 x_(n+1)) the value is 1/(x_1 x_2).
    """
    near = xp.abs(square) <= _NEAR * _NEAR
    inside = where(near, square, 1.0)
    x = 0.0 * inside
    for level in range(_LEVELS, 1, -1):
        x = 1 / (2 * level + inside * x)
    small = (2 + inside * x) / x
    w = xp.sqrt(where(near, _NEAR * _NEAR, square))
    tail = 0.0 * w
    for coefficient in reversed(_SERIES):
        tail = (tail + coefficient) / w
    large = w * w / (1 - 2 * (1 + tail) / w)
    return where(near, small, large)
