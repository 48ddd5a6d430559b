"""Viscous damping coefficients (VDC) of oil and gaps, gap conductance, and the seals' secant VDC.

The pipe-flow VDC of the oil and the secant VDC of the seals differ by a factor of 1e5 and more.
They are two quantities and must not be merged. Incremental damping (dF/dv) is
`friction.stribeck_slope`.
"""

from __future__ import annotations

import math

from ..base.numeric import Array, geometry, namespace, real, where


@geometry
def pipe_flow(*, dynamic_viscosity: Array, length: Array) -> Array:
    """VDC of laminar pipe flow over a length, c = 8 pi eta L, for any bore.

    The wall shear of this flow acts on the barrel, not on the rod.

    Parameters
    ----------
    dynamic_viscosity : [Pa s]
    length : stroke [m]

    Returns
    -------
    VDC [N s/m]

    Notes
    -----
    Valid: developed laminar flow at the piston speed.

    References
    ----------
    [ElAsswad2018] eq. 2, 3, 4, 5, 6

    Examples
    --------
    >>> print(f"{pipe_flow(dynamic_viscosity=0.04, length=0.2):.6f}")
    0.201062
    """
    return (8 * math.pi) * dynamic_viscosity * length


@geometry
def annular_couette(
    *, dynamic_viscosity: Array, length: Array, inner_radius: Array, outer_radius: Array
) -> Array:
    """VDC of a rod drawn through a concentric tube of oil, 2 pi eta L/ln(r_o/r_i).

    Parameters
    ----------
    dynamic_viscosity : [Pa s]
    length : [m]
    inner_radius, outer_radius : [m]

    Returns
    -------
    VDC [N s/m]; NaN where r_o <= r_i

    Notes
    -----
    Valid: no axial pressure gradient.

    References
    ----------
    [derived] axial Couette flow between cylinders

    Examples
    --------
    >>> c = annular_couette(dynamic_viscosity=0.04, length=0.2, inner_radius=9e-3,
    ...                     outer_radius=20e-3)
    >>> print(f"{c:.7f}")
    0.0629493
    """
    valid = (real(outer_radius) > real(inner_radius)) & (real(inner_radius) > 0)
    ratio = where(valid, outer_radius, math.e) / where(valid, inner_radius, 1.0)
    value = (2 * math.pi) * dynamic_viscosity * length / namespace(ratio).log(ratio)
    return where(valid, value, math.nan)


@geometry
def flat_gap(*, dynamic_viscosity: Array, diameter: Array, length: Array, gap: Array) -> Array:
    """VDC of shear in a thin cylindrical gap, pi d L eta/h.

    Parameters
    ----------
    dynamic_viscosity : [Pa s]
    diameter : of the rod or piston [m]
    length : [m]
    gap : film or radial clearance h [m]

    Returns
    -------
    VDC [N s/m]

    Notes
    -----
    Valid: gap much smaller than the diameter.

    References
    ----------
    [Huang2017] eq. 24 per speed

    Examples
    --------
    >>> print(f"{flat_gap(dynamic_viscosity=0.04, diameter=18e-3, length=0.02, gap=30e-6):.4f}")
    1.5080
    """
    return math.pi * dynamic_viscosity * diameter * length / gap


@geometry
def gap_conductance(
    *,
    diameter: Array,
    gap: Array,
    dynamic_viscosity: Array,
    length: Array,
    eccentricity: Array = 0.0,
) -> Array:
    """Conductance dq/d(dp) of an annular gap, pi D h^3/(12 eta L) (1 + 1.5 e^2).

    Parameters
    ----------
    diameter : [m]
    gap : mean radial clearance h [m]
    dynamic_viscosity : [Pa s]
    length : [m]
    eccentricity : offset over h [-], 0 to 1

    Returns
    -------
    conductance [m^3/s/Pa]

    Notes
    -----
    Valid: laminar, gap much smaller than the diameter.

    References
    ----------
    [Merritt1967] annular leakage with eccentricity

    Examples
    --------
    >>> g = gap_conductance(diameter=0.04, gap=30e-6, dynamic_viscosity=0.04, length=0.02)
    >>> print(f"{g:.5e}")
    3.53429e-13
    """
    concentric = (math.pi / 12) * diameter * gap * gap * gap / (dynamic_viscosity * length)
    return concentric * (1 + 1.5 * eccentricity * eccentricity)


def secant(*, friction: Array, speed: Array) -> Array:
    """Secant VDC of the seals, B = F(v)/v; always report the speed with it.

    Parameters
    ----------
    friction : total friction at the speed, with its sign [N]
    speed : [m/s]

    Returns
    -------
    VDC [N s/m]; NaN at speed 0, where it has no value

    Notes
    -----
    Valid: steady sliding. Not the damping of a vibration (that is dF/dv).

    References
    ----------
    [Huang2017] eq. 31

    Examples
    --------
    >>> secant(friction=550.0, speed=0.05)
    11000.0
    """
    moving = real(speed) != 0
    return where(moving, friction / where(moving, speed, 1.0), math.nan)


def power_law(*, speed: Array, coefficient: Array, exponent: Array) -> Array:
    """Power-law fit of the secant VDC, B = a v^b; b < 0 if B falls with speed.

    The source prints b > 0, which contradicts its own falling curves.

    Parameters
    ----------
    speed : > 0 [m/s]
    coefficient : a, its value at 1 m/s [N s/m]
    exponent : b [-]

    Returns
    -------
    VDC [N s/m]; NaN at speed <= 0

    Notes
    -----
    Valid: the speeds of the fit.

    References
    ----------
    [Huang2017] section 2, test B

    Examples
    --------
    >>> print(f"{power_law(speed=0.01, coefficient=1000.0, exponent=-1.0):.0f}")
    100000
    """
    valid = real(speed) > 0
    return where(valid, coefficient * where(valid, speed, 1.0) ** exponent, math.nan)


def double_exponential(
    *,
    speed: Array,
    coefficient_1: Array,
    rate_1: Array,
    coefficient_2: Array,
    rate_2: Array,
) -> Array:
    """Double-exponential fit of the secant VDC, B = a1 e^(b1 v) + a2 e^(b2 v); b1, b2 < 0.

    Parameters
    ----------
    speed : [m/s]
    coefficient_1, coefficient_2 : a1, a2 [N s/m]
    rate_1, rate_2 : b1, b2 [s/m]

    Returns
    -------
    VDC [N s/m]

    Notes
    -----
    Valid: the speeds of the fit.

    References
    ----------
    [Huang2017] section 2, test B

    Examples
    --------
    >>> b = double_exponential(speed=0.0, coefficient_1=2e5, rate_1=-400.0, coefficient_2=5e4,
    ...                        rate_2=-20.0)
    >>> print(f"{b:.0f}")
    250000
    """
    xp = namespace(speed, rate_1, rate_2)
    first = coefficient_1 * xp.exp(rate_1 * speed)
    return first + coefficient_2 * xp.exp(rate_2 * speed)
