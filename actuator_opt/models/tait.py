"""The Tait equation of a mineral oil: density and tangent bulk modulus.

Pressures are gauge, temperatures in kelvin. K0 = zero_modulus exp(-c T) is the isothermal modulus
at zero pressure, B = 1 + K0'.
"""

from __future__ import annotations

from ..base.numeric import Array, namespace

TAIT_PRESSURE, TAIT_TEMPERATURES = 350e5, (273.15, 423.15)
"""Gauge pressure (Pa) and temperatures (K) for which the constants of the generic oil stand."""


def _zero_pressure_modulus(zero_modulus: Array, coefficient: Array, temperature: Array) -> Array:
    """K0 at a temperature."""
    cooled = coefficient * temperature
    return zero_modulus * namespace(cooled).exp(-cooled)


def density_tait(
    *,
    temperature: Array,
    pressure: Array,
    reference_density: Array = 870.0,
    volume_expansion: Array = 7.7e-4,
    reference_temperature: Array = 273.15,
    zero_modulus: Array = 8.4e9,
    temperature_coefficient: Array = 0.0058,
    pressure_coefficient: Array = 11.9,
) -> Array:
    """Density of a mineral oil by the Tait equation.

    V/V0 = [1 + alpha_V (T - T0)] [1 - ln(1 + B p/K0)/B], rho = rho0/(V/V0).

    Parameters
    ----------
    temperature, reference_temperature : [K]
    pressure : gauge [Pa]
    reference_density : at T0 and zero gauge pressure [kg/m^3]
    volume_expansion : [1/K]
    zero_modulus, temperature_coefficient : of K0, c [Pa], [1/K]
    pressure_coefficient : B [-]

    Returns
    -------
    density [kg/m^3]

    Notes
    -----
    Valid: 0 to 150 degC, up to 350 bar for the default constants.

    References
    ----------
    [Dymond1988] Tait equation; constants of a generic mineral oil [OpenHydraulics]

    Examples
    --------
    >>> print(f"{density_tait(temperature=313.15, pressure=200e5):.1f}")
    855.6
    """
    modulus = _zero_pressure_modulus(zero_modulus, temperature_coefficient, temperature)
    load = pressure_coefficient * pressure / modulus
    shrink = namespace(load).log1p(load) / pressure_coefficient
    expand = 1 + volume_expansion * (temperature - reference_temperature)
    return reference_density / (expand * (1 - shrink))


def bulk_modulus_tait(
    *,
    temperature: Array,
    pressure: Array,
    zero_modulus: Array = 8.4e9,
    temperature_coefficient: Array = 0.0058,
    pressure_coefficient: Array = 11.9,
) -> Array:
    """Isothermal tangent bulk modulus of a mineral oil by the Tait equation.

    K = (K0 + B p) [1 - ln(1 + B p/K0)/B].

    Parameters
    ----------
    temperature : [K]
    pressure : gauge [Pa]
    zero_modulus, temperature_coefficient : of K0, c [Pa], [1/K]
    pressure_coefficient : B [-]

    Returns
    -------
    tangent bulk modulus [Pa]

    Notes
    -----
    Valid: 0 to 150 degC, up to 350 bar for the default constants.

    References
    ----------
    [Dymond1988] Tait equation; constants of a generic mineral oil [OpenHydraulics]

    Examples
    --------
    >>> print(f"{bulk_modulus_tait(temperature=313.15, pressure=280e5) / 1e6:.1f}")
    1668.1
    """
    modulus = _zero_pressure_modulus(zero_modulus, temperature_coefficient, temperature)
    load = pressure_coefficient * pressure / modulus
    return modulus * (1 + load) * (1 - namespace(load).log1p(load) / pressure_coefficient)
