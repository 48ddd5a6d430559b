"""A chamber that keeps its mass: oil with entrained air over pressure, and the inverse.

The state is the reference volume, the volume the content takes at zero gauge pressure; it grows
by the net inflow times `density_ratio` at the pressure the flow comes from. Pressures are gauge.
The air stays undissolved and of constant mass. A chamber with air cannot pass -p_a.
"""

from __future__ import annotations

import math

from ..geometry import geometry
from ..numeric import (
    Array,
    absolute,
    log1p_quotient,
    maximum,
    minimum,
    namespace,
    real,
    sqrt,
    where,
)
from .fluid import ATMOSPHERIC_PRESSURE

_STEPS = 100
_TOLERANCE = 1e-11
_LEAST_PRESSURE = 1e-200
_EMPTY = 1e-60
"""Density ratio below which a chamber with air is at -p_a (a choice: it is so to rounding)."""


def density_ratio(
    *,
    pressure: Array,
    bulk_modulus: Array,
    slope: Array = 0.0,
    air_content: Array = 0.0,
    polytropic_index: Array = 1.4,
    atmospheric_pressure: Array = ATMOSPHERIC_PRESSURE,
) -> Array:
    """Density over the density at zero gauge pressure, (1 + alpha)/(f + alpha r).

    f = e^(-p/K) of the oil, (1 + m p/K)^(-1/m) with a slope m; r = (p_a/(p_a + p))^(1/n).

    Parameters
    ----------
    pressure : gauge [Pa]
    bulk_modulus : tangent value of the pure oil at zero gauge pressure, K [Pa]
    slope : m = dK/dp of the pure oil [-]
    air_content : alpha, free air over oil volume at zero gauge pressure [-]
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


@geometry
def reference_volume(
    *,
    volume: Array,
    pressure: Array,
    bulk_modulus: Array,
    slope: Array = 0.0,
    air_content: Array = 0.0,
    polytropic_index: Array = 1.4,
    atmospheric_pressure: Array = ATMOSPHERIC_PRESSURE,
) -> Array:
    """Volume that the content of a chamber takes at zero gauge pressure; V e^(p/K) of pure oil.

    V_ref = V (1 + alpha)/(f + alpha r), f and r as in `density_ratio`; dV_ref/dp = V_ref/K_eff
    with K_eff of `mixture_bulk_modulus`.

    Parameters
    ----------
    volume : of the chamber [m^3]
    pressure : gauge [Pa]
    bulk_modulus : tangent value of the pure oil at zero gauge pressure, K [Pa]
    slope : m = dK/dp of the pure oil [-]
    air_content : alpha, free air over oil volume at zero gauge pressure [-]
    polytropic_index : n [-]
    atmospheric_pressure : p_a, absolute [Pa]

    Returns
    -------
    reference volume [m^3]; NaN with air at p <= -p_a, and where 1 + m p/K <= 0

    Notes
    -----
    Valid: air neither dissolves nor is released.

    References
    ----------
    [derived] mass of the content over its density at zero gauge pressure

    Examples
    --------
    >>> v = reference_volume(volume=1e-4, pressure=200e5, bulk_modulus=1.4e9)
    >>> print(f"{v * 1e6:.4f} cm3")
    101.4388 cm3
    """
    return volume * density_ratio(
        pressure=pressure,
        bulk_modulus=bulk_modulus,
        slope=slope,
        air_content=air_content,
        polytropic_index=polytropic_index,
        atmospheric_pressure=atmospheric_pressure,
    )


def mixture_bulk_modulus(
    *,
    pressure: Array,
    bulk_modulus: Array,
    slope: Array = 0.0,
    air_content: Array = 0.0,
    polytropic_index: Array = 1.4,
    atmospheric_pressure: Array = ATMOSPHERIC_PRESSURE,
) -> Array:
    """Tangent bulk modulus that keeps the mass, K_eff = (f + alpha r)/(f/K_p + alpha r/(n P)).

    P = p + p_a, K_p = K + m p, f and r as in `density_ratio`. It is
    `fluid.effective_bulk_modulus` with the air over the oil volume at the pressure itself,
    alpha/f, and without that formula's floor: it tends to n P as P falls to zero.

    Parameters
    ----------
    pressure : gauge [Pa]
    bulk_modulus : tangent value of the pure oil at zero gauge pressure, K [Pa]
    slope : m = dK/dp of the pure oil [-]
    air_content : alpha, free air over oil volume at zero gauge pressure [-]
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
    [derived] V_ref/(dV_ref/dp) of `reference_volume`; [AaltoThesis] eq. 5 with alpha/f

    Examples
    --------
    >>> k = mixture_bulk_modulus(pressure=20e5, bulk_modulus=1600e6, air_content=0.005)
    >>> print(f"{k / 1e6:.0f} MPa")
    1220 MPa
    """
    law = (bulk_modulus, slope, air_content, polytropic_index, atmospheric_pressure)
    change, gas, falling = _shares(pressure + atmospheric_pressure, law, pressure)
    return (1 + change + gas) / falling


def chamber_pressure(
    *,
    density_ratio: Array,
    bulk_modulus: Array,
    slope: Array = 0.0,
    air_content: Array = 0.0,
    polytropic_index: Array = 1.4,
    atmospheric_pressure: Array = ATMOSPHERIC_PRESSURE,
) -> Array:
    """Pressure of a chamber from its reference volume over its volume: `density_ratio` inverted.

    With w = (1 + alpha) V/V_ref, f + alpha r - w is convex and falls in P = p + p_a. As
    w/2 <= max(f, alpha r) <= w, both laws alone bracket P. Newton steps that leave the bracket
    or double P give way to its geometric mean; the last step carries the derivatives.

    Parameters
    ----------
    density_ratio : V_ref/V [-]
    bulk_modulus : tangent value of the pure oil at zero gauge pressure, K [Pa]
    slope : m = dK/dp of the pure oil [-]
    air_content : alpha, free air over oil volume at zero gauge pressure [-]
    polytropic_index : n [-]
    atmospheric_pressure : p_a, absolute [Pa]

    Returns
    -------
    gauge pressure [Pa], not below -p_a with air; K ln(V_ref/V) of pure oil; NaN at a ratio < 0

    Notes
    -----
    Valid: ratio 0.5 to 2, from 0 with air; pure oil may come out in tension, below -p_a.

    References
    ----------
    [derived] inverse of `density_ratio`

    Examples
    --------
    >>> for ratio in (1.02, 1.01, 0.9, 0.01):
    ...     p = chamber_pressure(density_ratio=ratio, bulk_modulus=1.4e9, air_content=0.01)
    ...     print(f"{p / 1e5:.4f} bar")
    142.0521 bar
    17.5506 bar
    -0.9828 bar
    -1.0132 bar
    """
    filled = real(density_ratio) > _EMPTY
    wanted = (1 + air_content) / where(filled, density_ratio, 1.0)
    law = (bulk_modulus, slope, air_content, polytropic_index, atmospheric_pressure)
    plain = (
        real(bulk_modulus), real(slope), real(air_content), real(polytropic_index),
        real(atmospheric_pressure),
    )  # fmt: skip
    total = _solved(real(wanted), plain)
    start = total - plain[-1]
    change, gas, falling = _shares(total + (atmospheric_pressure - plain[-1]), law, start)
    drained = (real(density_ratio) >= 0) & (real(air_content) > 0)
    empty = where(drained, 0 * wanted - atmospheric_pressure, math.nan)
    return where(filled, start + (change + gas - (wanted - 1)) / falling, empty)


@geometry
def pressure_rate(
    *, flow: Array, volume: Array, volume_rate: Array, bulk_modulus: Array, compliance: Array = 0.0
) -> Array:
    """Pressure rise of a chamber, dp/dt = (q - dV/dt)/(V/K_eff + C_wall).

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
    [MECE5005] pressure of a cylinder chamber; [derived] rate of `reference_volume`

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

    `total` is absolute; the gauge pressure beside it keeps the digits that the other one loses.
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


def _oil_alone(volume: Array, modulus: Array, slope: Array) -> Array:
    """Gauge pressure at which pure oil takes a volume, all real: -K ln w, K (w^-m - 1)/m."""
    xp = namespace(volume, modulus, slope)
    depth = -xp.log(volume)
    load = slope * depth
    straight = absolute(load) < 1e-5
    safe = where(straight, 1.0 + 0 * load, load)
    mean = where(straight, 1 + load / 2 + load * load / 6, xp.expm1(safe) / safe)
    return modulus * depth * mean


def _solved(wanted: Array, law: tuple[Array, Array, Array, Array, Array]) -> Array:
    """Absolute pressure at a volume over the oil's at zero gauge pressure, all real."""
    modulus, slope, air, index, atmosphere = law
    pure = _oil_alone(wanted, modulus, slope) + atmosphere
    mixed = air > 0
    if not namespace(mixed).any(mixed):
        return pure
    amount = where(mixed, air, 1.0 + 0 * air)
    law = (modulus, slope, amount, index, atmosphere)
    low, high = _bracket(wanted, law)
    pressure = low
    for _ in range(_STEPS):
        change, gas, falling = _shares(pressure, law)
        missing = change + gas - (wanted - 1)
        step = missing / falling
        size = absolute(where(mixed, step, 0.0))
        found = size <= _TOLERANCE * pressure
        if namespace(found).all(found):
            break
        low, high = where(missing > 0, pressure, low), where(missing > 0, high, pressure)
        inside = (pressure + step > low) & (pressure + step < high) & (size <= pressure)
        pressure = where(inside, pressure + step, sqrt(low) * sqrt(high))
    return where(mixed, pressure, pure)


def _bracket(wanted: Array, law: tuple[Array, Array, Array, Array, Array]) -> tuple[Array, Array]:
    """Absolute pressures on both sides of the solution, the lower one above zero, all real.

    f < f(-p_a) as well, so alpha r > w - f(-p_a): a sharper upper bound where there is much gas.
    """
    modulus, slope, air, index, atmosphere = law
    low = maximum(
        _oil_alone(wanted, modulus, slope) + atmosphere, atmosphere * (air / wanted) ** index
    )
    low = maximum(low, _LEAST_PRESSURE)
    half = 0.5 * wanted
    high = maximum(
        _oil_alone(half, modulus, slope) + atmosphere, atmosphere * (air / half) ** index
    )
    bare = wanted - 1 - _shares(0.0 * wanted, law)[0]
    gaseous = bare > 0
    ceiling = atmosphere * (air / where(gaseous, bare, 1.0)) ** index
    return low, maximum(where(gaseous, minimum(high, ceiling), high), low) * (1 + _TOLERANCE)
