"""Elastic energy of the oil and air in a chamber, for the energy balance of a simulation.

Pressures are gauge: the work against the atmosphere is not counted.
"""

from __future__ import annotations

from ..base.numeric import Array, expm1_quotient, log1p_quotient, namespace, real, where
from .fluid import ATMOSPHERIC_PRESSURE


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
