"""Hydraulic fluid: viscosity, vapour pressure, bulk modulus, and the effect of entrained air.

Density and the Tait equation are in `oil_laws`. Pressures are gauge unless a name says
``absolute``; temperatures are in kelvin. A bulk modulus is the isothermal *tangent* value K = -V
dp/dV, unless it is called a secant value.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from ..base.numeric import Array, maximum, namespace, real, where

ATMOSPHERIC_PRESSURE = 101325.0
"""Standard atmosphere, Pa absolute."""
LEAST_VISCOSITY = 2e-6
"""Smallest kinematic viscosity for which ASTM D341 holds in the form used here, m^2/s."""
BARUS_PRESSURE, ROELANDS_PRESSURE, LINEAR_PRESSURE = 1e8, 1e9, 500e5
"""Gauge pressures up to which Barus's law, Roelands's law and the linear bulk modulus hold, Pa."""


def viscosity_astm_d341(
    *, temperature: Array, points_temperature: Sequence[Array], points_viscosity: Sequence[Array]
) -> Array:
    """Kinematic viscosity at a temperature, from two or more known points.

    ln ln(nu + 0.7) = a - b ln T between neighbouring points (nu in mm^2/s); the end segments
    continue outside. The result is exact at every given point.

    Parameters
    ----------
    temperature : [K]
    points_temperature : [K], strictly ascending
    points_viscosity : [m^2/s], one per temperature

    Returns
    -------
    kinematic viscosity [m^2/s]; NaN at temperature <= 0

    Raises
    ------
    ValueError
        Fewer than two points, or lists of unequal length.

    Notes
    -----
    Valid: 2 mm^2/s and above, near the given points.

    For a fluid with a viscosity improver, two points do not extrapolate to low temperatures: give
    three or more.

    References
    ----------
    [ASTM-D341] double-logarithmic chart

    Examples
    --------
    >>> vg32 = dict(points_temperature=(313.15, 373.15), points_viscosity=(32e-6, 5.36e-6))
    >>> print(f"{viscosity_astm_d341(temperature=293.15, **vg32) * 1e6:.1f} mm2/s")
    86.8 mm2/s
    """
    if len(points_temperature) != len(points_viscosity) or len(points_temperature) < 2:
        raise ValueError("state two or more points, with one viscosity for each temperature")
    xp = namespace(temperature, *points_temperature, *points_viscosity)
    valid = real(temperature) > 0
    x = xp.log(where(valid, temperature, points_temperature[0]))
    xs = [xp.log(t) for t in points_temperature]
    ys = [xp.log(xp.log(1e6 * nu + 0.7)) for nu in points_viscosity]
    y: Array = None
    for x0, x1, y0, y1 in zip(xs, xs[1:], ys, ys[1:], strict=False):
        segment = y0 + (y1 - y0) / (x1 - x0) * (x - x0)
        y = segment if y is None else where(real(x) > real(x0), segment, y)
    return where(valid, 1e-6 * (xp.exp(xp.exp(y)) - 0.7), math.nan)


def dynamic_viscosity(*, kinematic_viscosity: Array, density: Array) -> Array:
    """Dynamic viscosity eta = rho nu.

    Parameters
    ----------
    kinematic_viscosity : [m^2/s]
    density : [kg/m^3]

    Returns
    -------
    dynamic viscosity [Pa s]

    Notes
    -----
    Valid: everywhere.

    References
    ----------
    [derived] definition of the kinematic viscosity

    Examples
    --------
    >>> round(dynamic_viscosity(kinematic_viscosity=46e-6, density=870.0), 5)
    0.04002
    """
    return density * kinematic_viscosity


def barus(*, viscosity: Array, pressure: Array, coefficient: Array) -> Array:
    """Dynamic viscosity under pressure, eta = eta0 exp(alpha p).

    Parameters
    ----------
    viscosity : dynamic viscosity at zero gauge pressure [Pa s]
    pressure : gauge [Pa]
    coefficient : pressure-viscosity coefficient alpha [1/Pa]

    Returns
    -------
    dynamic viscosity [Pa s]

    Notes
    -----
    Valid: up to about 0.1 GPa; Roelands beyond.

    References
    ----------
    [Barus1893] exponential law

    Examples
    --------
    >>> print(f"{barus(viscosity=0.0186, pressure=30e6, coefficient=20e-9):.6f}")
    0.033891
    """
    product = coefficient * pressure
    return viscosity * namespace(product).exp(product)


def roelands(*, viscosity: Array, pressure: Array, coefficient: Array) -> Array:
    """Dynamic viscosity under pressure by Roelands; tends to Barus as p -> 0.

    eta = eta0 exp{L [(1 + p/p0)^Z - 1]}, L = ln eta0 + 9.67, Z = alpha/(5.1e-9 L),
    p0 = 1.96e8 Pa.

    Parameters
    ----------
    viscosity : dynamic viscosity at zero gauge pressure [Pa s]
    pressure : gauge [Pa]
    coefficient : Barus coefficient alpha at zero pressure [1/Pa]

    Returns
    -------
    dynamic viscosity [Pa s]; NaN below eta0 = 6.3e-5 Pa s (L <= 0) or p <= -p0

    Notes
    -----
    Valid: 0 to 1 GPa.

    References
    ----------
    [Huang2017] eq. 2 (minus signs lost in the text copy), [Roelands1966]

    Examples
    --------
    >>> print(f"{roelands(viscosity=0.0186, pressure=30e6, coefficient=20e-9):.6f}")
    0.033449
    """
    xp = namespace(viscosity, pressure, coefficient)
    valid = (real(viscosity) > 6.32e-5) & (real(pressure) > -1.96e8)
    safe = where(valid, viscosity, 1.0)
    slope = xp.log(safe) + 9.67
    exponent = coefficient / (5.1e-9 * slope)
    growth = xp.exp(exponent * xp.log1p(where(valid, pressure, 0.0) / 1.96e8)) - 1
    return where(valid, safe * xp.exp(slope * growth), math.nan)


def vapour_pressure(
    *, temperature: Array, points_temperature: Sequence[Array], points_pressure: Sequence[Array]
) -> Array:
    """Vapour pressure at a temperature, from two or more known points.

    ln p = a - b/T between neighbouring points; the end segments continue outside.

    Parameters
    ----------
    temperature : [K]
    points_temperature : [K], strictly ascending
    points_pressure : absolute, above zero [Pa], one per temperature

    Returns
    -------
    vapour pressure, absolute [Pa]; NaN at temperature <= 0

    Raises
    ------
    ValueError
        Fewer than two points, or lists of unequal length.

    Notes
    -----
    Valid: near the given points, far below the critical temperature.

    References
    ----------
    [derived] Clausius-Clapeyron with a constant heat of evaporation and an ideal vapour

    Examples
    --------
    >>> water = dict(points_temperature=(313.15, 333.15), points_pressure=(7384.9, 19947.0))
    >>> print(f"{vapour_pressure(temperature=323.15, **water) / 1e3:.2f} kPa")
    12.33 kPa
    """
    if len(points_temperature) != len(points_pressure) or len(points_temperature) < 2:
        raise ValueError("state two or more points, with one pressure for each temperature")
    xp = namespace(temperature, *points_temperature, *points_pressure)
    valid = real(temperature) > 0
    x = 1 / where(valid, temperature, points_temperature[0])
    xs = [1 / t for t in points_temperature]
    ys = [xp.log(p) for p in points_pressure]
    y: Array = None
    for x0, x1, y0, y1 in zip(xs, xs[1:], ys, ys[1:], strict=False):
        segment = y0 + (y1 - y0) / (x1 - x0) * (x - x0)
        y = segment if y is None else where(real(x) < real(x0), segment, y)
    return where(valid, xp.exp(y), math.nan)


def bulk_modulus_linear(*, bulk_modulus: Array, slope: Array, pressure: Array) -> Array:
    """Tangent bulk modulus growing linearly with pressure, K = K0 + m p.

    Parameters
    ----------
    bulk_modulus : tangent value at zero gauge pressure [Pa]
    slope : m = dK/dp [-] (0 for a constant, about 6 to 11 for mineral oils)
    pressure : gauge [Pa]

    Returns
    -------
    tangent bulk modulus [Pa]

    Notes
    -----
    Valid: 0 to 500 bar, pure liquid.

    References
    ----------
    [derived] first-order expansion of K(p)

    Examples
    --------
    >>> round(bulk_modulus_linear(bulk_modulus=1.4e9, slope=6.0, pressure=200e5) / 1e6)
    1520
    """
    return bulk_modulus + slope * pressure


def bulk_modulus_warm(
    *, bulk_modulus: Array, decay: Array, temperature: Array, reference_temperature: Array
) -> Array:
    """Bulk modulus at another temperature, K = K_ref exp(-b (T - T_ref)).

    Parameters
    ----------
    bulk_modulus : K_ref at the reference temperature [Pa]
    decay : b, relative fall per kelvin [1/K] (0.0058 for mineral oil)
    temperature, reference_temperature : [K]

    Returns
    -------
    tangent bulk modulus [Pa]

    Notes
    -----
    Valid: within some 60 K of the reference.

    References
    ----------
    [derived] the exponential factor of K0 in `oil_laws.bulk_modulus_tait`

    Examples
    --------
    >>> k = bulk_modulus_warm(bulk_modulus=1367e6, decay=0.0058, temperature=333.15,
    ...                       reference_temperature=313.15)
    >>> print(f"{k / 1e6:.0f} MPa")
    1217 MPa
    """
    change = decay * (reference_temperature - temperature)
    return bulk_modulus * namespace(change).exp(change)


def effective_bulk_modulus(
    *,
    bulk_modulus: Array,
    pressure: Array,
    air_content: Array,
    polytropic_index: Array = 1.4,
    atmospheric_pressure: Array = ATMOSPHERIC_PRESSURE,
) -> Array:
    """Tangent bulk modulus of oil with entrained air: oil and polytropic gas in parallel.

    K_eff = K (1 + alpha r)/(1 + alpha r K/(n (p_a + p))), r = (p_a/(p_a + p))^(1/n).

    Parameters
    ----------
    bulk_modulus : tangent value of the pure oil at this pressure [Pa]
    pressure : gauge pressure [Pa]; below -0.9 p_a, the value at -0.9 p_a is used
    air_content : alpha, volume of free air / volume of oil at atmospheric pressure [-]
    polytropic_index : n [-]: 1.4 fast (adiabatic), 1.0 slow (isothermal)
    atmospheric_pressure : absolute [Pa]

    Returns
    -------
    tangent bulk modulus [Pa]

    Notes
    -----
    Valid: undissolved air only; air content up to about 0.2.

    References
    ----------
    [AaltoThesis] eq. 5

    Examples
    --------
    >>> k = effective_bulk_modulus(bulk_modulus=1600e6, pressure=20e5, air_content=0.005)
    >>> print(f"{k / 1e6:.0f}")
    1220
    """
    absolute_pressure = maximum(pressure, -0.9 * atmospheric_pressure) + atmospheric_pressure
    gas = air_content * (atmospheric_pressure / absolute_pressure) ** (1 / polytropic_index)
    softening = gas * bulk_modulus / (polytropic_index * absolute_pressure)
    return bulk_modulus * (1 + gas) / (1 + softening)
