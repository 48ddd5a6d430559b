"""Gas-charged accumulators: gas volume, capacitance, usable volume and size.

Pressures are gauge, as everywhere; the gas laws add the atmospheric pressure themselves. An
accumulator connected to a line is `line_ends.accumulator_end`: inertance and resistance of its neck
in series with this capacitance.
"""

from __future__ import annotations

from ..base.numeric import Array, geometry, maximum, minimum, positive, real, where
from .fluid import ATMOSPHERIC_PRESSURE


@geometry
def gas_volume_at(
    *,
    pressure: Array,
    precharge_pressure: Array,
    gas_volume: Array,
    polytropic_index: Array = 1.0,
    atmospheric_pressure: Array = ATMOSPHERIC_PRESSURE,
) -> Array:
    """Gas volume at an oil pressure, V = V0 ((p0 + p_a)/(p + p_a))^(1/n).

    Parameters
    ----------
    pressure : oil pressure, gauge [Pa]; at or below the precharge the gas fills the shell
    precharge_pressure : p0, gauge [Pa], at the temperature of use
    gas_volume : V0, at the precharge pressure [m^3]
    polytropic_index : n [-]: 1.0 slow (isothermal), 1.4 fast (adiabatic nitrogen)
    atmospheric_pressure : absolute [Pa]

    Returns
    -------
    gas volume [m^3]

    Notes
    -----
    Valid: ideal gas, to about 200 bar; pressures above -p_a.

    References
    ----------
    [derived] polytropic ideal gas of constant mass, p V^n constant

    Examples
    --------
    >>> v = gas_volume_at(pressure=100e5, precharge_pressure=60e5, gas_volume=1e-3)
    >>> print(f"{v * 1e3:.4f} l")
    0.6040 l
    """
    start = precharge_pressure + atmospheric_pressure
    now = maximum(pressure + atmospheric_pressure, start)
    return gas_volume * (start / now) ** (1 / polytropic_index)


@geometry
def gas_capacitance(
    *,
    pressure: Array,
    precharge_pressure: Array,
    gas_volume: Array,
    polytropic_index: Array = 1.4,
    filling_index: Array = 1.0,
    atmospheric_pressure: Array = ATMOSPHERIC_PRESSURE,
) -> Array:
    """Capacitance of the gas for small vibrations, C = V/(n (p + p_a)).

    First, slow filling compresses the gas to V with `filling_index`. Then the gas oscillates fast
    about V with the polytropic index n.

    Parameters
    ----------
    pressure : mean oil pressure, gauge [Pa]
    precharge_pressure : gauge [Pa], at the temperature of use
    gas_volume : at the precharge pressure [m^3]
    polytropic_index : n of the vibration [-]: 1.4 above some tenths of a hertz
    filling_index : polytropic index while the accumulator was filled [-]: 1.0 if slowly
    atmospheric_pressure : absolute [Pa]

    Returns
    -------
    capacitance -dV/dp [m^3/Pa]; 0 below the precharge, where no oil has entered

    Notes
    -----
    Valid: ideal gas, to about 200 bar; amplitudes much smaller than the mean.

    References
    ----------
    [derived] slope of `gas_volume_at`

    Examples
    --------
    >>> c = gas_capacitance(pressure=100e5, precharge_pressure=60e5, gas_volume=1e-3)
    >>> print(f"{c:.3e}")
    4.271e-11
    """
    filled = gas_volume_at(
        pressure=pressure,
        precharge_pressure=precharge_pressure,
        gas_volume=gas_volume,
        polytropic_index=filling_index,
        atmospheric_pressure=atmospheric_pressure,
    )
    working = real(pressure) > real(precharge_pressure)
    absolute_pressure = where(working, pressure, precharge_pressure) + atmospheric_pressure
    return where(working, filled / (polytropic_index * absolute_pressure), 0.0)


@geometry
def usable_volume(
    *,
    low_pressure: Array,
    high_pressure: Array,
    precharge_pressure: Array,
    gas_volume: Array,
    polytropic_index: Array = 1.4,
    filling_index: Array = 1.0,
    atmospheric_pressure: Array = ATMOSPHERIC_PRESSURE,
) -> Array:
    """Oil volume that an accumulator delivers between a high and a low pressure.

    Filling to the high pressure compresses the gas to V with `filling_index`. The gas then expands
    with n down to the low pressure, or until it fills the shell:
    min(V ((p_high + p_a)/(p_low + p_a))^(1/n), V0) - V.

    Parameters
    ----------
    low_pressure, high_pressure : gauge [Pa], high >= low
    precharge_pressure : gauge [Pa], at the temperature of use
    gas_volume : V0, at the precharge pressure [m^3]
    polytropic_index : n of the discharge [-]: 1.4 within seconds, 1.0 over minutes
    filling_index : polytropic index while the accumulator was filled [-]: 1.0 if slowly
    atmospheric_pressure : absolute [Pa]

    Returns
    -------
    oil volume [m^3]

    Notes
    -----
    Valid: ideal gas, to about 200 bar.

    References
    ----------
    [derived] `gas_volume_at` from the filled state

    Examples
    --------
    >>> v = usable_volume(low_pressure=70e5, high_pressure=140e5, precharge_pressure=60e5,
    ...                   gas_volume=1e-3)
    >>> print(f"{v * 1e3:.3f} l")
    0.274 l
    """
    shell = {"precharge_pressure": precharge_pressure, "gas_volume": gas_volume}
    filled = gas_volume_at(
        pressure=high_pressure,
        polytropic_index=filling_index,
        atmospheric_pressure=atmospheric_pressure,
        **shell,
    )
    ratio = (high_pressure + atmospheric_pressure) / (low_pressure + atmospheric_pressure)
    expanded = filled * ratio ** (1 / polytropic_index)
    return minimum(expanded, gas_volume) - filled


@geometry
def gas_volume_needed(
    *,
    oil_volume: Array,
    low_pressure: Array,
    high_pressure: Array,
    precharge_pressure: Array,
    polytropic_index: Array = 1.4,
    filling_index: Array = 1.0,
    atmospheric_pressure: Array = ATMOSPHERIC_PRESSURE,
) -> Array:
    """Gas volume of an accumulator that delivers an oil volume: `usable_volume` solved for V0.

    V0 = dV/u, where u is the usable volume per gas volume. While the gas does not fill the shell,
    V0 = dV/{((p0 + p_a)/(p_high + p_a))^(1/m) [((p_high + p_a)/(p_low + p_a))^(1/n) - 1]}, with
    the filling index m.

    Parameters
    ----------
    oil_volume : dV to deliver between the two pressures [m^3]
    low_pressure, high_pressure : gauge [Pa], high > low
    precharge_pressure : p0, gauge [Pa], at the temperature of use
    polytropic_index : n of the discharge [-]: 1.4 for cycles under a minute, 1.0 above
    filling_index : m while the accumulator was filled [-]: 1.0 if slowly
    atmospheric_pressure : absolute [Pa]

    Returns
    -------
    V0, at the precharge pressure [m^3]; NaN where the pressures leave no usable volume

    Notes
    -----
    Valid: ideal gas, to about 200 bar; real nitrogen above needs up to 20 % more.

    References
    ----------
    [derived] `usable_volume` is proportional to V0

    Examples
    --------
    >>> v = gas_volume_needed(oil_volume=7.375e-6, low_pressure=190e5, high_pressure=210e5,
    ...                       precharge_pressure=171e5)
    >>> print(f"{v * 1e3:.4f} l")
    0.1227 l
    """
    share = usable_volume(
        low_pressure=low_pressure,
        high_pressure=high_pressure,
        precharge_pressure=precharge_pressure,
        gas_volume=1.0,
        polytropic_index=polytropic_index,
        filling_index=filling_index,
        atmospheric_pressure=atmospheric_pressure,
    )
    return oil_volume / positive(share)


@geometry
def gas_pressure(
    *,
    volume: Array,
    precharge_pressure: Array,
    gas_volume: Array,
    polytropic_index: Array = 1.0,
    atmospheric_pressure: Array = ATMOSPHERIC_PRESSURE,
) -> Array:
    """Gas pressure at a gas volume, (p0 + p_a)(V0/V)^n - p_a: `gas_volume_at` inverted.

    Parameters
    ----------
    volume : V of the gas [m^3], > 0
    precharge_pressure : p0, gauge [Pa]
    gas_volume : V0, at the precharge pressure [m^3]
    polytropic_index : n [-]
    atmospheric_pressure : absolute [Pa]

    Returns
    -------
    gauge pressure [Pa]

    Notes
    -----
    Valid: ideal gas, to about 200 bar; V up to V0.

    References
    ----------
    [derived] polytropic ideal gas of constant mass, p V^n constant

    Examples
    --------
    >>> p = gas_pressure(volume=0.6040e-3, precharge_pressure=60e5, gas_volume=1e-3)
    >>> print(f"{p / 1e5:.1f} bar")
    100.0 bar
    """
    start = precharge_pressure + atmospheric_pressure
    return start * (gas_volume / volume) ** polytropic_index - atmospheric_pressure
