"""Density of the oil over temperature and pressure, and the pressure of trapped warming oil.

Pressures are gauge, temperatures in kelvin. The Tait equation lives in `tait`.
"""

from __future__ import annotations

from ..base.numeric import Array, namespace, real, where


def density_compressed(
    *, reference_density: Array, pressure: Array, bulk_modulus: Array, slope: Array = 0.0
) -> Array:
    """Density under pressure of a liquid whose bulk modulus is K0 + m p.

    rho = rho0 (1 + m p/K0)^(1/m); rho0 exp(p/K0) where m = 0.

    Parameters
    ----------
    reference_density : at zero gauge pressure [kg/m^3]
    pressure : gauge [Pa]
    bulk_modulus : tangent value at zero gauge pressure, K0 [Pa]
    slope : m = dK/dp [-]

    Returns
    -------
    density [kg/m^3]

    Notes
    -----
    Valid: 0 to 500 bar, pure liquid.

    References
    ----------
    [derived] integral of drho/rho = dp/(K0 + m p)

    Examples
    --------
    >>> rho = density_compressed(reference_density=870.0, pressure=200e5, bulk_modulus=1.4e9,
    ...                          slope=6.0)
    >>> print(f"{rho:.2f} kg/m3")
    882.01 kg/m3
    """
    strain = pressure / bulk_modulus
    load = slope * strain
    xp = namespace(strain, load)
    small = (real(load) < 1e-5) & (real(load) > -1e-5)
    safe = where(small, 0 * load + 1, load)
    mean = where(small, 1 - load / 2 + load * load / 3, xp.log1p(safe) / safe)
    return reference_density * xp.exp(strain * mean)


def density_thermal(
    *,
    reference_density: Array,
    volume_expansion: Array,
    temperature: Array,
    reference_temperature: Array = 288.15,
) -> Array:
    """Density at a temperature, rho = rho0/(1 + alpha_V (T - T0)).

    Parameters
    ----------
    reference_density : at `reference_temperature` [kg/m^3]
    volume_expansion : volumetric expansion coefficient [1/K]
    temperature, reference_temperature : [K]; oil data sheets state 15 degC

    Returns
    -------
    density [kg/m^3]

    Notes
    -----
    Valid: within about 150 K of the reference temperature.

    References
    ----------
    [derived] definition of alpha_V, taken on the reference volume

    Examples
    --------
    >>> round(density_thermal(reference_density=870.0, volume_expansion=7e-4,
    ...                       temperature=313.15), 2)
    855.04
    """
    return reference_density / (1 + volume_expansion * (temperature - reference_temperature))


def thermal_pressure_slope(
    *,
    volume_expansion: Array,
    wall_expansion_axial: Array,
    wall_expansion_hoop: Array,
    bulk_modulus: Array,
    wall_compliance_per_volume: Array,
) -> Array:
    """Pressure rise of trapped oil per kelvin.

    dp/dT = (alpha_V - alpha_z - 2 alpha_theta)/(1/K + (dV/dp)_wall/V).

    Parameters
    ----------
    volume_expansion : of the oil [1/K]
    wall_expansion_axial, wall_expansion_hoop : linear expansions of the wall [1/K]
    bulk_modulus : tangent value with air [Pa]
    wall_compliance_per_volume : (dV/dp)/V of the wall [1/Pa]

    Returns
    -------
    pressure rise [Pa/K]

    Notes
    -----
    Valid: no leakage, no relief valve, chamber full.

    References
    ----------
    [derived] oil volume = chamber volume, both functions of p and T

    Examples
    --------
    >>> slope = thermal_pressure_slope(volume_expansion=7e-4, wall_expansion_axial=12e-6,
    ...     wall_expansion_hoop=12e-6, bulk_modulus=1.4e9, wall_compliance_per_volume=1.3627e-10)
    >>> print(f"{slope / 1e5:.2f} bar/K")
    7.81 bar/K
    """
    wall = wall_expansion_axial + 2 * wall_expansion_hoop
    return (volume_expansion - wall) / (1 / bulk_modulus + wall_compliance_per_volume)
