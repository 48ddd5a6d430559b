"""Oil under pressure and temperature: density, Tait equation, trapped oil, and laws by name.

A design may name a law of bulk modulus or viscosity. A new law is an entry in `BULK_MODULUS_LAWS`
or `VISCOSITY_LAWS` with its name, the properties it needs, its formula and its range. Pressures are
gauge, temperatures in kelvin. In the Tait equation K0 = zero_modulus exp(-c T) is the isothermal
modulus at zero pressure, and B = 1 + K0'.
"""

from __future__ import annotations

from collections.abc import Callable
from math import inf
from typing import Any

from ..base.dataclass import dataclass
from ..base.kinds import kinds
from ..base.numeric import Array, namespace, real, where
from . import fluid


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
    temperature, reference_temperature : [K]; the density on oil data sheets is that at 15 degC

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
    volume_expansion : alpha_V of the oil [1/K]
    wall_expansion_axial, wall_expansion_hoop : alpha_z, alpha_theta of the wall [1/K]
    bulk_modulus : tangent value of the oil with its air [Pa]
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


TAIT_PRESSURE, TAIT_TEMPERATURES = 350e5, (273.15, 423.15)
"""Largest gauge pressure (Pa) and temperature range (K) for the generic oil's Tait constants."""


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
    zero_modulus, temperature_coefficient : for K0 = zero_modulus exp(-c T) [Pa], [1/K]
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
    zero_modulus, temperature_coefficient : for K0 = zero_modulus exp(-c T) [Pa], [1/K]
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


Properties = Callable[[str], Any]
"""Function that returns a property of the oil [SI] by its name in the material library; None if the
library does not state it."""


@dataclass(frozen=True, slots=True)
class BulkModulusLaw:
    """Law by which tangent bulk modulus and density of an oil without air change with pressure.

    Attributes
    ----------
    name, help : word that selects the law in a design, and the meaning of this word
    needs : properties of the oil beyond bulk modulus and density
    modulus : function of (properties, temperature [K], gauge pressure [Pa]) that returns the
        tangent bulk modulus [Pa]
    density : function of (properties, density at zero pressure, temperature, pressure) that
        returns the density [kg/m^3]
    largest_pressure : gauge pressure up to which the law holds [Pa]
    model : function of `models` that states the law's formula; None for a law without a formula
    """

    name: str
    help: str
    needs: tuple[str, ...]
    modulus: Callable[[Properties, Array, Array], Array]
    density: Callable[[Properties, Array, Array, Array], Array]
    largest_pressure: float
    model: Callable[..., Array] | None


@dataclass(frozen=True, slots=True)
class ViscosityLaw:
    """Law by which viscosity changes with pressure.

    Attributes
    ----------
    name, help : word that selects the law in a design, and the meaning of this word
    needs : properties of the oil; the first is the coefficient of the law [1/Pa]
    model : function of (viscosity, pressure, coefficient) that returns the dynamic viscosity; None
        if it does not depend on pressure
    largest_pressure : gauge pressure up to which the law holds [Pa]
    words : name of the law in a report
    """

    name: str
    help: str
    needs: tuple[str, ...]
    model: Callable[..., Array] | None
    largest_pressure: float
    words: str

    def viscosity(self, *, viscosity: Array, pressure: Array, coefficient: Array) -> Array:
        """Dynamic viscosity at a gauge pressure [Pa s], from its value at zero gauge pressure."""
        if self.model is None:
            return viscosity + 0 * pressure
        return self.model(viscosity=viscosity, pressure=pressure, coefficient=coefficient)


def _warm(oil: Properties, temperature: Array, pressure: Array) -> Array:
    """Stated bulk modulus of the oil (at its stated pressure), corrected to `temperature`."""
    modulus, decay = oil("bulk_modulus"), oil("bulk_modulus_decay")
    if decay is None:
        return modulus
    return fluid.bulk_modulus_warm(
        bulk_modulus=modulus,
        decay=decay,
        temperature=temperature,
        reference_temperature=oil("bulk_modulus_temperature"),
    )


def _linear(oil: Properties, temperature: Array, pressure: Array) -> Array:
    reference = oil("bulk_modulus_pressure")
    return fluid.bulk_modulus_linear(
        bulk_modulus=_warm(oil, temperature, pressure),
        slope=oil("bulk_modulus_slope"),
        pressure=pressure - (0.0 if reference is None else reference),
    )


def _tait_constants(oil: Properties) -> dict[str, Array]:
    return {
        "zero_modulus": oil("tait_modulus"),
        "temperature_coefficient": oil("tait_decay"),
        "pressure_coefficient": oil("tait_coefficient"),
    }


def _tait(oil: Properties, temperature: Array, pressure: Array) -> Array:
    return bulk_modulus_tait(temperature=temperature, pressure=pressure, **_tait_constants(oil))


def _compressed(
    modulus: Callable[[Properties, Array, Array], Array], *, sloped: bool
) -> Callable[[Properties, Array, Array, Array], Array]:
    """Function that gives the density for a bulk modulus that is constant or linear in pressure.

    The bulk modulus is linear in pressure if `sloped`, else constant.
    """

    def density_at(oil: Properties, rho: Array, temperature: Array, pressure: Array) -> Array:
        return density_compressed(
            reference_density=rho,
            pressure=pressure,
            bulk_modulus=modulus(oil, temperature, 0.0 * pressure),
            slope=oil("bulk_modulus_slope") if sloped else 0.0,
        )

    return density_at


def _tait_density(oil: Properties, rho: Array, temperature: Array, pressure: Array) -> Array:
    return density_tait(
        temperature=temperature,
        pressure=pressure,
        reference_density=rho,
        volume_expansion=0.0,
        **_tait_constants(oil),
    )


BULK_MODULUS_LAWS = kinds(
    "law of the bulk modulus",
    BulkModulusLaw(
        "constant",
        "not at all",
        needs=(),
        modulus=_warm,
        density=_compressed(_warm, sloped=False),
        largest_pressure=inf,
        model=None,
    ),
    BulkModulusLaw(
        "linear",
        "linearly, by the slope stated for the oil",
        needs=("bulk_modulus_slope",),
        modulus=_linear,
        density=_compressed(_linear, sloped=True),
        largest_pressure=fluid.LINEAR_PRESSURE,
        model=fluid.bulk_modulus_linear,
    ),
    BulkModulusLaw(
        "tait",
        "by the Tait equation, with three constants of the oil",
        needs=("tait_modulus", "tait_decay", "tait_coefficient"),
        modulus=_tait,
        density=_tait_density,
        largest_pressure=TAIT_PRESSURE,
        model=bulk_modulus_tait,
    ),
)
"""Laws of the bulk modulus by name."""

VISCOSITY_LAWS = kinds(
    "law of the viscosity",
    ViscosityLaw(
        "none",
        "not at all",
        needs=(),
        model=None,
        largest_pressure=inf,
        words="independent of pressure",
    ),
    ViscosityLaw(
        "barus",
        "exponentially",
        needs=("pressure_viscosity",),
        model=fluid.barus,
        largest_pressure=fluid.BARUS_PRESSURE,
        words="under pressure by Barus",
    ),
    ViscosityLaw(
        "roelands",
        "by Roelands's law: less than exponentially at high pressure",
        needs=("pressure_viscosity",),
        model=fluid.roelands,
        largest_pressure=fluid.ROELANDS_PRESSURE,
        words="under pressure by Roelands",
    ),
)
"""Laws of the viscosity by name."""
