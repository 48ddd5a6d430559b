"""Mass balance and elastic energy of a chamber filled with oil and entrained air, and cavitation.

The state of a chamber is its reference volume: the volume that its oil and air would have at zero
gauge pressure. It grows by the net inflow times the `density_ratio` at the pressure upstream of the
flow. Pressures are gauge. The air stays undissolved and keeps its mass. With air the pressure of a
chamber cannot fall to -p_a. In oil without air a cavity opens below atmospheric pressure and closes
above it.
"""

from __future__ import annotations

import math

from ..base.numeric import Array, expm1_quotient, geometry, log1p_quotient, namespace, real, where
from .fluid import ATMOSPHERIC_PRESSURE


def density_ratio(
    *,
    pressure: Array,
    bulk_modulus: Array,
    slope: Array = 0.0,
    air_content: Array = 0.0,
    polytropic_index: Array = 1.4,
    atmospheric_pressure: Array = ATMOSPHERIC_PRESSURE,
) -> Array:
    """Density of oil with air, relative to zero gauge pressure: (1 + alpha)/(f + alpha r).

    Oil: f = e^(-p/K), or (1 + m p/K)^(-1/m) with a slope m. Air: r = (p_a/(p_a + p))^(1/n).

    Parameters
    ----------
    pressure : gauge [Pa]
    bulk_modulus : tangent value of the pure oil at zero gauge pressure, K [Pa]
    slope : m = dK/dp of the pure oil [-]
    air_content : alpha, volume of free air / volume of oil at zero gauge pressure [-]
    polytropic_index : n [-]: 1.4 fast (adiabatic), 1.0 slow (isothermal)
    atmospheric_pressure : p_a, absolute [Pa]

    Returns
    -------
    ratio [-]; NaN with air at p <= -p_a, and where 1 + m p/K <= 0

    Notes
    -----
    Valid: air neither dissolves nor is released; the density of the air is left out.

    References
    ----------
    [derived] oil of tangent modulus K + m p beside a polytropic gas of constant mass

    Examples
    --------
    >>> print(f"{density_ratio(pressure=200e5, bulk_modulus=1.4e9):.6f}")
    1.014388
    >>> print(f"{density_ratio(pressure=-0.5e5, bulk_modulus=1.4e9, air_content=0.01):.6f}")
    0.993810
    """
    law = (bulk_modulus, slope, air_content, polytropic_index, atmospheric_pressure)
    change, gas, _ = _shares(pressure + atmospheric_pressure, law, pressure)
    return (1 + air_content) / (1 + change + gas)


def mixture_bulk_modulus(
    *,
    pressure: Array,
    bulk_modulus: Array,
    slope: Array = 0.0,
    air_content: Array = 0.0,
    polytropic_index: Array = 1.4,
    atmospheric_pressure: Array = ATMOSPHERIC_PRESSURE,
) -> Array:
    """Tangent bulk modulus by conservation of mass, K_eff = (f + alpha r)/(f/K_p + alpha r/(n P)).

    P = p + p_a, K_p = K + m p, f and r as in `density_ratio`. The result equals
    `fluid.effective_bulk_modulus` with K_p and the air content alpha/f, because that function
    relates the air to the oil volume at this pressure. Unlike that formula, which stops at
    -0.9 p_a, it tends to n P as P falls to zero.

    Parameters
    ----------
    pressure : gauge [Pa]
    bulk_modulus : tangent value of the pure oil at zero gauge pressure, K [Pa]
    slope : m = dK/dp of the pure oil [-]
    air_content : alpha, volume of free air / volume of oil at zero gauge pressure [-]
    polytropic_index : n [-]
    atmospheric_pressure : p_a, absolute [Pa]

    Returns
    -------
    tangent bulk modulus [Pa]; NaN with air at p <= -p_a, and where 1 + m p/K <= 0

    Notes
    -----
    Valid: air neither dissolves nor is released.

    References
    ----------
    [derived] V_ref/(dV_ref/dp) of V_ref = V `density_ratio`; [AaltoThesis] eq. 5 with alpha/f

    Examples
    --------
    >>> k = mixture_bulk_modulus(pressure=20e5, bulk_modulus=1600e6, air_content=0.005)
    >>> print(f"{k / 1e6:.0f} MPa")
    1220 MPa
    """
    law = (bulk_modulus, slope, air_content, polytropic_index, atmospheric_pressure)
    change, gas, falling = _shares(pressure + atmospheric_pressure, law, pressure)
    return (1 + change + gas) / falling


@geometry
def pressure_rate(
    *, flow: Array, volume: Array, volume_rate: Array, bulk_modulus: Array, compliance: Array = 0.0
) -> Array:
    """Rate of the pressure in a chamber, dp/dt = (q - dV/dt)/(V/K_eff + C_wall).

    Parameters
    ----------
    flow : q, net inflow at the density of the chamber [m^3/s]
    volume : of the chamber [m^3]
    volume_rate : dV/dt by the motion of the piston [m^3/s]
    bulk_modulus : K_eff, `mixture_bulk_modulus` at the chamber's pressure [Pa]
    compliance : dV/dp of the walls [m^3/Pa]

    Returns
    -------
    rate [Pa/s]

    Notes
    -----
    Valid: one pressure in the chamber, slower than its pressure waves.

    References
    ----------
    [MECE5005] pressure of a cylinder chamber; [derived] rate of V `density_ratio`

    Examples
    --------
    >>> rate = pressure_rate(flow=1e-4, volume=1e-4, volume_rate=0.4e-4, bulk_modulus=1.4e9)
    >>> print(f"{rate / 1e5:.0f} bar/s")
    8400 bar/s
    """
    return (flow - volume_rate) / (volume / bulk_modulus + compliance)


def _shares(
    total: Array, law: tuple[Array, Array, Array, Array, Array], pressure: Array = None
) -> tuple[Array, Array, Array]:
    """Change of the oil volume f - 1, gas volume alpha r, and -d(f + alpha r)/dp.

    f, alpha and r are those of `density_ratio`; `total` is the absolute pressure. If the gauge
    `pressure` is known too, pass it, because near zero it has more significant digits than `total`.
    """
    modulus, slope, air, index, atmosphere = law
    strain = (total - atmosphere if pressure is None else pressure) / modulus
    load = slope * strain
    change = namespace(strain, load).expm1(-strain * log1p_quotient(load))
    open_gas = real(total) > 0
    pressed = where(open_gas, total, atmosphere)
    ratio = (atmosphere / pressed) ** (1 / index)
    gas = where(open_gas | (real(air) == 0), air * ratio, math.nan)
    falling = (1 + change) / (modulus * (1 + load)) + gas / (index * pressed)
    return change, gas, falling


def cavity(
    *,
    pressure: Array,
    content: Array,
    polytropic_index: Array = 1.4,
    atmospheric_pressure: Array = ATMOSPHERIC_PRESSURE,
) -> tuple[Array, Array, Array]:
    """Volume G of a cavity in the oil, -dG/dp, and the work to open it, all per oil volume.

    The oil volume is that at zero gauge pressure. G = c (r - 1)^2 with r = (p_a/(p_a + p))^(1/n)
    below zero gauge pressure, and 0 above. Volume and slope are continuous, and the pressure never
    falls to a vacuum. The work to open the cavity is
    -int p dG = c p_a ((r - 1)^2 - 2 ((r^(2-n) - 1)/(2 - n) - (r^(1-n) - 1)/(1 - n))).

    Parameters
    ----------
    pressure : gauge pressure p [Pa], above -p_a
    content : c, scale of G; it limits the tension in the oil [-] (a choice)
    polytropic_index : n of the gas in the cavity [-]
    atmospheric_pressure : p_a [Pa]

    Returns
    -------
    volume G [-], -dG/dp [1/Pa], work per oil volume [J/m^3]; all zero from p = 0 up

    Notes
    -----
    Valid: any pressure above vacuum.

    This formula is not a physical law of cavitation; it only limits the tension in the oil.

    References
    ----------
    [derived] quadratic in the expansion of a polytropic gas, so that no gas is left at p = 0

    Examples
    --------
    >>> for pressure in (1e5, -0.5e5, -0.9e5):
    ...     volume, falling, work = cavity(pressure=pressure, content=1e-4)
    ...     print(f"{volume:.3e} {falling:.3e} {work:.3f}")
    0.000e+00 0.000e+00 0.000
    3.913e-05 2.830e-09 1.482
    1.432e-03 2.283e-07 116.027
    """
    n = polytropic_index
    opened = real(pressure) < 0
    left = atmospheric_pressure + where(opened, pressure, 0 * pressure)
    share = namespace(left, n).log(atmospheric_pressure / left) / n
    grown = share * expm1_quotient(share)  # r - 1, which keeps its digits near zero
    volume = content * grown * grown
    falling = 2 * content * grown * (1 + grown) / (n * left)
    change = share * (expm1_quotient((2 - n) * share) - expm1_quotient((1 - n) * share))
    return volume, falling, content * atmospheric_pressure * (grown * grown - 2 * change)


def oil_energy_density(
    *,
    pressure: Array,
    bulk_modulus: Array,
    slope: Array = 0.0,
    air_content: Array = 0.0,
    polytropic_index: Array = 1.4,
    atmospheric_pressure: Array = ATMOSPHERIC_PRESSURE,
) -> Array:
    """Elastic energy of oil and air per total volume, e = (u_oil + alpha u_air)/(f + alpha r).

    u = -integral of p dw from 0 to p, with the volume w per volume of oil at zero gauge pressure:
    u_oil = K (f^(1-m) - 1)/(m - 1) - p f, f = (1 + m p/K)^(-1/m), or K (1 - f) - p f with
    f = e^(-p/K) at m = 0; u_air = (P r - p_a)/(n - 1) - p_a (1 - r), or p_a ln(P/p_a) - p_a (1 - r)
    at n = 1, with P = p + p_a and r = (p_a/P)^(1/n). The code uses expm1(x)/x and log1p(x)/x,
    so that m = 0, m = 1 and n = 1 need no branch.

    Parameters
    ----------
    pressure : p, gauge [Pa]
    bulk_modulus : tangent value of the pure oil at zero gauge pressure, K [Pa]
    slope : m = dK/dp of the pure oil [-]
    air_content : alpha, volume of free air / volume of oil at zero gauge pressure [-]
    polytropic_index : n [-]
    atmospheric_pressure : p_a, absolute [Pa]

    Returns
    -------
    energy per volume [J/m^3], p^2/(2 K) for stiff oil; NaN with air at p <= -p_a

    Notes
    -----
    Valid: range of `chamber.density_ratio`.

    With the flow q into the volume V, d(e V)/dt = q e + p (q - dV/dt).

    References
    ----------
    [derived] work of a fixed mass under its own pressure

    Examples
    --------
    >>> print(f"{oil_energy_density(pressure=140e5, bulk_modulus=1.4e9):.1f} J/m^3")
    70233.9 J/m^3
    """
    xp = namespace(pressure, bulk_modulus, air_content)
    strain = pressure / bulk_modulus
    depth = -strain * log1p_quotient(slope * strain)
    shrunk = xp.exp(depth)
    oil = -bulk_modulus * depth * expm1_quotient((1 - slope) * depth) - pressure * shrunk
    total = pressure + atmospheric_pressure
    open_gas = real(total) > 0
    pressed = where(open_gas, total, atmospheric_pressure)
    ratio = (atmospheric_pressure / pressed) ** (1 / polytropic_index)
    share = xp.log(pressed / atmospheric_pressure) / polytropic_index
    work = atmospheric_pressure * share * expm1_quotient((polytropic_index - 1) * share)
    gas = work - atmospheric_pressure * (1 - ratio)
    energy = (oil + air_content * gas) / (shrunk + air_content * ratio)
    return where(open_gas | (real(air_content) == 0), energy, xp.nan)
