"""Pipes, hoses and ports: compliance, volume, flow, pressure drop, friction of oscillating flow.

Lines are round and full; a positive flow gives a positive pressure drop. Their lumped elements are
in `elements`. The series impedance depends on the friction model, chosen by name:

`lossless`     none
`steady`       the laminar resistance of steady flow, at every frequency
`distributed`  laminar flow whose velocity profile depends on the frequency [DSouza1964]
"""

from __future__ import annotations

import math
from typing import Any

from ..base.numeric import Array, absolute, clip, geometry, maximum, namespace, real, where

LAMINAR_REYNOLDS = 2300.0
"""Largest Reynolds number of pure Hagen-Poiseuille flow."""
TURBULENT_REYNOLDS = 4000.0
"""Least Reynolds number of pure Blasius friction."""


@geometry
def line_compliance(
    *,
    inner_diameter: Array,
    outer_diameter: Array,
    length: Array,
    youngs_modulus: Array,
    poissons_ratio: Array,
) -> Array:
    """Swelling of a pipe, hose or open-ended barrel, dV/dp of its wall.

    dV/dp = pi D^2 l (lambda + nu)/(2 E), lambda = (Do^2 + D^2)/(Do^2 - D^2).

    Parameters
    ----------
    inner_diameter, outer_diameter : [m]
    length : [m]
    youngs_modulus : [Pa] (a hose: 17.8 GPa is one measurement at 160 bar)
    poissons_ratio : [-]

    Returns
    -------
    dV/dp [m^3/Pa]; NaN where the outer diameter does not exceed the inner one

    Notes
    -----
    Valid: isotropic wall, free axial length (open ends).

    References
    ----------
    [AaltoThesis] eq. 24, 25, 26 as a volume per pressure; [derived] open-ended Lamé cylinder

    Examples
    --------
    >>> c = line_compliance(inner_diameter=9.5e-3, outer_diameter=12e-3, length=0.6,
    ...                     youngs_modulus=17.8e9, poissons_ratio=0.3)
    >>> print(f"{c * 1e15:.1f} mm3/MPa")
    22.3 mm3/MPa
    """
    inner = inner_diameter * inner_diameter
    outer = outer_diameter * outer_diameter
    wall = outer - inner
    valid = real(wall) > 0
    growth = (outer + inner) / where(valid, wall, 1.0) + poissons_ratio
    compliance = (0.5 * math.pi) * inner * length * growth / youngs_modulus
    return where(valid, compliance, math.nan)


@geometry
def line_volume(*, inner_diameter: Array, length: Array) -> Array:
    """Oil volume of a line, pi D^2 l/4.

    Parameters
    ----------
    inner_diameter : [m]
    length : [m]

    Returns
    -------
    volume [m^3]

    Notes
    -----
    Valid: everywhere.

    References
    ----------
    [derived] volume of a cylinder

    Examples
    --------
    >>> print(f"{line_volume(inner_diameter=9.5e-3, length=0.1) * 1e6:.3f} ml")
    7.088 ml
    """
    return (0.25 * math.pi) * inner_diameter * inner_diameter * length


@geometry
def line_velocity(*, flow: Array, inner_diameter: Array) -> Array:
    """Mean oil speed in a line, v = 4 q/(pi D^2).

    Parameters
    ----------
    flow : [m^3/s]
    inner_diameter : [m]

    Returns
    -------
    speed [m/s]

    Notes
    -----
    Valid: everywhere.

    References
    ----------
    [derived] continuity

    Examples
    --------
    >>> print(f"{line_velocity(flow=10 / 60000, inner_diameter=8e-3):.3f}")
    3.316
    """
    return (4 / math.pi) * flow / (inner_diameter * inner_diameter)


@geometry
def port_velocity(*, flow: Array, port_diameter: Array) -> Array:
    """Mean oil speed in a port, v = q/A_port.

    Parameters
    ----------
    flow : [m^3/s]
    port_diameter : [m]

    Returns
    -------
    speed [m/s]

    Notes
    -----
    Valid: everywhere.

    References
    ----------
    [derived] continuity

    Examples
    --------
    >>> print(f"{port_velocity(flow=10 / 60000, port_diameter=6e-3):.3f}")
    5.895
    """
    return line_velocity(flow=flow, inner_diameter=port_diameter)


@geometry
def reynolds(*, velocity: Array, diameter: Array, kinematic_viscosity: Array) -> Array:
    """Reynolds number Re = v D/nu of a round line.

    Parameters
    ----------
    velocity : [m/s]
    diameter : [m]
    kinematic_viscosity : [m^2/s]

    Returns
    -------
    Reynolds number [-]

    Notes
    -----
    Valid: everywhere.

    References
    ----------
    [derived] definition of the Reynolds number

    Examples
    --------
    >>> round(reynolds(velocity=4.0, diameter=8e-3, kinematic_viscosity=32e-6))
    1000
    """
    return velocity * diameter / kinematic_viscosity


@geometry
def line_pressure_drop(
    *,
    flow: Array,
    inner_diameter: Array,
    length: Array,
    density: Array,
    dynamic_viscosity: Array,
) -> Array:
    """Friction pressure drop of a smooth straight line, laminar, turbulent or between.

    Laminar 128 eta l q/(pi d^4) up to Re 2300; Blasius f = 0.3164 Re^(-1/4) from Re 4000;
    between, the friction factors are blended by w^2 (3 - 2 w), w = (Re - 2300)/1700 (choice:
    once differentiable). In terms of Re, the drop is (eta^2 l/(rho d^3)) Re
    times 32 if laminar and times 0.1582 Re^(3/4) if turbulent.

    Parameters
    ----------
    flow : [m^3/s], either sign
    inner_diameter, length : [m]
    density : [kg/m^3]
    dynamic_viscosity : [Pa s]

    Returns
    -------
    pressure drop [Pa], with the sign of the flow

    Notes
    -----
    Valid: Re up to 1e5, hydraulically smooth, no bends or fittings.

    References
    ----------
    [AaltoThesis] section 2.1.3 (laminar), [Blasius1913]

    Examples
    --------
    >>> dp = line_pressure_drop(flow=1e-4, inner_diameter=8e-3, length=1.2, density=865.0,
    ...                         dynamic_viscosity=0.04)
    >>> print(f"{dp / 1e5:.3f} bar")
    0.477 bar
    """
    signed = (4 / math.pi) * density * flow / (inner_diameter * dynamic_viscosity)
    number = absolute(signed)
    span = TURBULENT_REYNOLDS - LAMINAR_REYNOLDS
    share = clip((number - LAMINAR_REYNOLDS) / span, 0.0, 1.0)
    share = share * share * (3 - 2 * share)
    turbulent = 0.1582 * maximum(number, LAMINAR_REYNOLDS) ** 0.75
    scale = dynamic_viscosity * dynamic_viscosity * length
    scale = scale / (density * inner_diameter * inner_diameter * inner_diameter)
    return scale * signed * (32 + share * (turbulent - 32))


@geometry
def fitting_pressure_drop(
    *, flow: Array, inner_diameter: Array, loss_coefficient: Array, density: Array
) -> Array:
    """Pressure drop of bends and fittings, dp = zeta rho/2 v |v|, with v = 4 q/(pi d^2).

    Parameters
    ----------
    flow : [m^3/s], either sign
    inner_diameter : of the line [m]
    loss_coefficient : zeta, the sum over all bends and fittings of the line [-]
    density : [kg/m^3]

    Returns
    -------
    pressure drop [Pa], with the sign of the flow

    Notes
    -----
    Valid: turbulent flow, in which zeta hardly depends on the Reynolds number.

    References
    ----------
    [derived] definition of the loss coefficient

    Examples
    --------
    >>> dp = fitting_pressure_drop(flow=2e-4, inner_diameter=8e-3, loss_coefficient=1.5,
    ...                            density=865.0)
    >>> print(f"{dp / 1e5:.4f} bar")
    0.1027 bar
    """
    velocity = line_velocity(flow=flow, inner_diameter=inner_diameter)
    return 0.5 * loss_coefficient * density * velocity * absolute(velocity)


FRICTION = ("lossless", "steady", "distributed")


_LEVELS = 28
"""Depth of the continued fraction; it and the series below are then exact to 1e-10 of the value."""


_NEAR = 20.0
"""Largest |r sqrt(i omega/nu)| at which the continued fraction is used; beyond it, the asymptotic
series is used."""


_SERIES = (-1 / 2, -1 / 8, -1 / 8, -25 / 128, -13 / 32, -1073 / 1024, -103 / 32)
"""Coefficients of I1(w)/I0(w) = 1 - 1/(2 w) - ... for large w."""


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
    friction : name of the friction model, `lossless`, `steady` or `distributed` [-]

    Returns
    -------
    complex impedance per length [Pa s/m^4]

    Raises
    ------
    ValueError
        An unknown friction model.

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
    """w^2/(1 - 2 I1(w)/(w I0(w))) from w^2: 8 + 4 w^2/3 for small, w^2 + 2 w + ... for large w.

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
