"""Heat transfer of an actuator: oil film, wall layers, free and forced convection, radiation.

Temperatures are absolute, in kelvin. Heat flow per area and kelvin is a film coefficient
[W/(m^2 K)]; its reciprocal over the area is a resistance [K/W].
"""

from __future__ import annotations

from math import log, pi
from typing import NamedTuple

from ..base.numeric import (
    Array,
    absolute,
    geometry,
    maximum,
    namespace,
    positive,
    real,
    sqrt,
    where,
)
from .fluid import ATMOSPHERIC_PRESSURE

GAS_CONSTANT = 287.05287
"""Gas constant of dry air [J/(kg K)] [USStandardAtmosphere1976]."""
AIR_SPECIFIC_HEAT = 1005.0
"""Specific heat of dry air at constant pressure, 7/2 R rounded [J/(kg K)]."""
STEFAN_BOLTZMANN = 5.670374419e-8
"""Stefan-Boltzmann constant [W/(m^2 K^4)] [CODATA2018]."""
GRAVITY = 9.80665
"""Standard acceleration of gravity [m/s^2]."""
NUSSELT_AT_REST = 3.66
"""Nusselt number of fully developed laminar flow in a pipe of constant wall temperature."""
LEAST_DIFFERENCE = 0.01
"""Difference of temperatures [K] below which free convection no longer falls, our choice: its
slope stays finite at equal temperatures."""


class AirProperties(NamedTuple):
    """Density [kg/m^3], dynamic viscosity [Pa s], conductivity [W/(m K)], Prandtl number [-]."""

    density: Array
    dynamic_viscosity: Array
    conductivity: Array
    prandtl_number: Array


def air_properties(
    *, temperature: Array, absolute_pressure: Array = ATMOSPHERIC_PRESSURE
) -> AirProperties:
    """Properties of dry air: rho = p/(R T), and viscosity and conductivity of Sutherland's form.

    eta = 1.458e-6 T^1.5/(T + 110.4), k = 2.64638e-3 T^1.5/(T + 245.4 10^(-12/T)), Pr = eta c_p/k.

    Parameters
    ----------
    temperature : of the air [K]
    absolute_pressure : of the air [Pa]

    Returns
    -------
    density [kg/m^3], dynamic viscosity [Pa s], conductivity [W/(m K)], Prandtl number [-]; NaN at a
    temperature that is not positive

    Notes
    -----
    Valid: 100 to 1000 K, dry air below 10 bar.

    References
    ----------
    [USStandardAtmosphere1976] eqs. 42, 51 and 53

    Examples
    --------
    >>> air = air_properties(temperature=288.15)
    >>> print(f"{air.density:.4f} {air.dynamic_viscosity:.4e} {air.conductivity:.6f}")
    1.2250 1.7894e-05 0.025326
    """
    temperature = positive(temperature)
    power = temperature * sqrt(temperature)
    viscosity = 1.458e-6 * power / (temperature + 110.4)
    decay = namespace(temperature).exp(-12 * log(10.0) / temperature)
    conductivity = 2.64638e-3 * power / (temperature + 245.4 * decay)
    density = absolute_pressure / (GAS_CONSTANT * temperature)
    prandtl = viscosity * AIR_SPECIFIC_HEAT / conductivity
    return AirProperties(density, viscosity, conductivity, prandtl)


def laminar_nusselt(*, graetz_number: Array) -> Array:
    """Mean Nusselt number of laminar pipe flow with thermal entry.

    Nu = 3.66 + 0.0668 Gz/(1 + 0.04 Gz^(2/3)), which is 3.66 at rest.

    Parameters
    ----------
    graetz_number : Gz = Re Pr D/L [-], 0 or more

    Returns
    -------
    Nusselt number on the diameter [-]; NaN at a negative Graetz number

    Notes
    -----
    Valid: Re < 2300, constant wall temperature; a piston's reciprocation adds mixing.

    The mixing of a reciprocating piston is not known: take a factor of 2 to 3 either way.

    References
    ----------
    [Hausen1943] as in [VDI2010]

    Examples
    --------
    >>> print(f"{laminar_nusselt(graetz_number=100.0):.4f}")
    7.2480
    """
    moves = real(graetz_number) > 0
    safe = where(moves, graetz_number, 0 * graetz_number + 1)
    growth = 0.0668 * graetz_number / (1 + 0.04 * safe ** (2 / 3))
    slow = where(real(graetz_number) < 0, graetz_number * float("nan"), 0.0668 * graetz_number)
    return NUSSELT_AT_REST + where(moves, growth, slow)


@geometry
def oil_film_coefficient(
    *,
    speed: Array,
    diameter: Array,
    length: Array,
    density: Array,
    specific_heat: Array,
    conductivity: Array,
) -> Array:
    """Film coefficient of oil in a chamber, h = Nu k/D with Gz = v D^2 rho c/(k L).

    The viscosity cancels out of Re Pr.

    Parameters
    ----------
    speed : v, mean speed of the oil, at least 0 [m/s]
    diameter, length : D and L, bore (or hydraulic diameter) and mean length of the chamber [m]
    density, specific_heat, conductivity : of the oil [kg/m^3], [J/(kg K)], [W/(m K)]

    Returns
    -------
    film coefficient [W/(m^2 K)]

    Notes
    -----
    Valid: as `laminar_nusselt`; factor 2 to 3 either way.

    References
    ----------
    [derived] `laminar_nusselt` with Re Pr = v D rho c/k

    Examples
    --------
    >>> oil = {"density": 870.0, "specific_heat": 1900.0, "conductivity": 0.13}
    >>> h = oil_film_coefficient(speed=0.13, diameter=23e-3, length=55e-3, **oil)
    >>> print(f"{h:.3f}")
    249.008
    """
    heat = speed * diameter * diameter * density * specific_heat
    graetz = heat / (positive(conductivity) * positive(length))
    return laminar_nusselt(graetz_number=graetz) * conductivity / positive(diameter)


def free_convection_nusselt(*, rayleigh_number: Array, prandtl_number: Array) -> Array:
    """Mean Nusselt number of free convection about a horizontal cylinder.

    Nu = {0.60 + 0.387 Ra^(1/6)/[1 + (0.559/Pr)^(9/16)]^(8/27)}^2

    Parameters
    ----------
    rayleigh_number : Ra on the diameter [-], > 0
    prandtl_number : Pr [-], > 0

    Returns
    -------
    Nusselt number on the diameter [-]; NaN where an argument is not positive

    Notes
    -----
    Valid: 1e-5 < Ra < 1e12, an isothermal cylinder in still air.

    References
    ----------
    [ChurchillChu1975]

    Examples
    --------
    >>> print(f"{free_convection_nusselt(rayleigh_number=1e5, prandtl_number=0.7):.4f}")
    7.7641
    """
    bracket = 1 + (0.559 / positive(prandtl_number)) ** (9 / 16)
    root = 0.60 + 0.387 * positive(rayleigh_number) ** (1 / 6) / bracket ** (8 / 27)
    return root * root


def cross_flow_nusselt(*, reynolds_number: Array, prandtl_number: Array) -> Array:
    """Mean Nusselt number of a cylinder in cross flow.

    Nu = 0.3 + 0.62 Re^(1/2) Pr^(1/3)/[1 + (0.4/Pr)^(2/3)]^(1/4) [1 + (Re/282000)^(5/8)]^(4/5)

    Parameters
    ----------
    reynolds_number : Re on the diameter [-], 0 or more
    prandtl_number : Pr [-], > 0

    Returns
    -------
    Nusselt number on the diameter [-]; 0.3 at rest; NaN at a negative Reynolds number

    Notes
    -----
    Valid: Re Pr > 0.2, Re < 1e7, flow across the axis.

    References
    ----------
    [ChurchillBernstein1977]

    Examples
    --------
    >>> print(f"{cross_flow_nusselt(reynolds_number=1e4, prandtl_number=0.7):.4f}")
    53.3278
    """
    moves = real(reynolds_number) > 0
    safe = where(moves, reynolds_number, 0 * reynolds_number + 1)
    prandtl = positive(prandtl_number)
    bracket = (1 + (0.4 / prandtl) ** (2 / 3)) ** 0.25
    turbulent = (1 + (safe / 282000.0) ** (5 / 8)) ** 0.8
    forced = 0.62 * sqrt(safe) * prandtl ** (1 / 3) / bracket * turbulent
    still = where(real(reynolds_number) < 0, reynolds_number * float("nan"), 0 * forced)
    return 0.3 + where(moves, forced, still)


@geometry
def convection_coefficient(
    *,
    surface_temperature: Array,
    ambient_temperature: Array,
    diameter: Array,
    air_speed: Array = 0.0,
    absolute_pressure: Array = ATMOSPHERIC_PRESSURE,
) -> Array:
    """Film coefficient of air about a cylinder: free or forced, whichever is larger.

    h = Nu k/D at the film temperature (T_s + T_a)/2. Ra = g |T_s - T_a| D^3 rho^2 Pr/(T_f eta^2),
    Re = rho v D/eta.

    Parameters
    ----------
    surface_temperature, ambient_temperature : T_s and T_a [K]
    diameter : outer, D [m]
    air_speed : across the axis, v, either sign [m/s]
    absolute_pressure : of the air [Pa]

    Returns
    -------
    film coefficient [W/(m^2 K)]

    Notes
    -----
    Valid: 1e-5 < Ra < 1e12, Re < 1e7; a horizontal cylinder alone in air.

    Differences far below 0.01 K count as 0.01 K, so that the slope is finite. The change from free
    to forced convection is a kink.

    References
    ----------
    [ChurchillChu1975], [ChurchillBernstein1977]; [derived] the larger of two (our choice)

    Examples
    --------
    >>> for wind in (0.0, 3.0):
    ...     h = convection_coefficient(surface_temperature=333.15, ambient_temperature=293.15,
    ...                                diameter=28.2e-3, air_speed=wind)
    ...     print(f"{h:.5f}")
    6.82010
    35.47481
    """
    film = 0.5 * (surface_temperature + ambient_temperature)
    air = air_properties(temperature=film, absolute_pressure=absolute_pressure)
    difference = surface_temperature - ambient_temperature
    difference = sqrt(difference * difference + LEAST_DIFFERENCE * LEAST_DIFFERENCE)
    kinematic = air.dynamic_viscosity / air.density
    cube = diameter * diameter * diameter
    rayleigh = GRAVITY * difference * cube * air.prandtl_number / (film * kinematic * kinematic)
    reynolds = absolute(air_speed) * diameter / kinematic
    free = free_convection_nusselt(rayleigh_number=rayleigh, prandtl_number=air.prandtl_number)
    forced = cross_flow_nusselt(reynolds_number=reynolds, prandtl_number=air.prandtl_number)
    return maximum(free, forced) * air.conductivity / positive(diameter)


def radiation_coefficient(
    *, emissivity: Array, surface_temperature: Array, ambient_temperature: Array
) -> Array:
    """Film coefficient of radiation, h = eps sigma (T_s^2 + T_a^2)(T_s + T_a).

    Parameters
    ----------
    emissivity : eps [-], 0 to 1
    surface_temperature, ambient_temperature : T_s, and T_a of the surroundings [K]

    Returns
    -------
    film coefficient [W/(m^2 K)]

    Notes
    -----
    Valid: a grey surface in large surroundings at the temperature of the air; no sun.

    Emissivity is near 0.9 for painted surfaces and laminates, 0.8 for anodised and 0.1 for bare
    aluminium (recalled).

    References
    ----------
    [derived] eps sigma (T_s^4 - T_a^4) divided by T_s - T_a

    Examples
    --------
    >>> h = radiation_coefficient(emissivity=0.9, surface_temperature=333.15,
    ...                           ambient_temperature=293.15)
    >>> print(f"{h:.5f}")
    6.29418
    """
    squares = surface_temperature * surface_temperature + ambient_temperature * ambient_temperature
    return emissivity * STEFAN_BOLTZMANN * squares * (surface_temperature + ambient_temperature)


@geometry
def layer_resistance(
    *, inner_radius: Array, outer_radius: Array, length: Array, conductivity: Array
) -> Array:
    """Resistance of a cylindrical layer to heat through its wall, R = ln(r_o/r_i)/(2 pi L k).

    Parameters
    ----------
    inner_radius, outer_radius : r_i and r_o [m]
    length : L [m]
    conductivity : k through the layer [W/(m K)], > 0

    Returns
    -------
    resistance [K/W]; NaN where the conductivity is not positive

    Notes
    -----
    Valid: heat flows in the radial direction only.

    References
    ----------
    [derived] Fourier's law, integrated over the radius

    Examples
    --------
    >>> r = layer_resistance(inner_radius=12.1e-3, outer_radius=13.3e-3, length=0.138,
    ...                      conductivity=0.6)
    >>> print(f"{r:.6f}")
    0.181757
    """
    ratio = outer_radius / positive(inner_radius)
    return namespace(ratio).log(ratio) / (2 * pi * positive(length) * positive(conductivity))


@geometry
def film_resistance(*, film_coefficient: Array, area: Array) -> Array:
    """Resistance of a film on a surface, R = 1/(h A).

    Parameters
    ----------
    film_coefficient : h, convection and radiation together [W/(m^2 K)], > 0
    area : A [m^2], > 0

    Returns
    -------
    resistance [K/W]; NaN where an argument is not positive

    Notes
    -----
    Valid: the coefficient is uniform over the area.

    References
    ----------
    [derived] definition of the film coefficient

    Examples
    --------
    >>> print(f"{film_resistance(film_coefficient=13.11428, area=pi * 28.2e-3 * 0.138):.4f}")
    6.2370
    """
    return 1 / (positive(film_coefficient) * positive(area))


def throttle_temperature_rise(
    *,
    pressure_drop: Array,
    density: Array,
    specific_heat: Array,
    volume_expansion: Array = 0.0,
    temperature: Array = 293.15,
) -> Array:
    """Temperature rise of oil across a throttle, dT = (1 - alpha_V T) dp/(rho c).

    Without `volume_expansion` it is dp/(rho c), so that energy closes from tank to tank: the share
    alpha_V T of a single throttle appears in the pump instead.

    Parameters
    ----------
    pressure_drop : dp, the mean weighted with the flow [Pa]
    density, specific_heat : of the oil [kg/m^3], [J/(kg K)], > 0
    volume_expansion : alpha_V [1/K]
    temperature : T of the oil [K]

    Returns
    -------
    rise [K]; NaN where density or specific heat is not positive

    Notes
    -----
    Valid: no heat passes the throttle's wall; properties at the mean pressure.

    References
    ----------
    [derived] constant enthalpy, dh = c dT + (1 - alpha_V T) dp/rho

    Examples
    --------
    >>> oil = {"density": 870.0, "specific_heat": 1900.0}
    >>> print(f"{throttle_temperature_rise(pressure_drop=175e5, **oil):.4f}")
    10.5868
    """
    share = 1 - volume_expansion * temperature
    return share * pressure_drop / (positive(density) * positive(specific_heat))


@geometry
def exchanged_volume(*, piston_area: Array, travel: Array, line_volume: Array) -> Array:
    """Fresh oil that a stroke brings into a chamber, V = max(0, A s - V_line).

    Behind a line longer than the volume of the stroke, the same oil moves to and fro and is never
    cooled by the supply.

    Parameters
    ----------
    piston_area : A, of the chamber's side [m^2]
    travel : s, of one stroke [m]
    line_volume : V_line, between chamber and valve [m^3]

    Returns
    -------
    volume per stroke [m^3]

    Notes
    -----
    Valid: plug flow; oil mixes in the chamber but not along the line.

    References
    ----------
    [derived] the oil of the line returns before any oil of the supply enters

    Examples
    --------
    >>> v = exchanged_volume(piston_area=4e-4, travel=0.06, line_volume=10e-6)
    >>> print(f"{v * 1e6:.1f} ml")
    14.0 ml
    """
    return maximum(piston_area * travel - line_volume, 0.0)


def oil_exchange_conductance(
    *, exchange_flow: Array, density: Array, specific_heat: Array
) -> Array:
    """Heat that exchanged oil carries per kelvin, G = rho c q.

    Parameters
    ----------
    exchange_flow : q, fresh oil into all chambers, mean over the cycle [m^3/s]
    density, specific_heat : of the oil [kg/m^3], [J/(kg K)]

    Returns
    -------
    conductance [W/K]

    Notes
    -----
    Valid: the oil of the chambers is mixed to one temperature.

    References
    ----------
    [derived] heat capacity of the flow

    Examples
    --------
    >>> print(oil_exchange_conductance(exchange_flow=2e-5, density=870.0, specific_heat=1900.0))
    33.06
    """
    return density * specific_heat * exchange_flow


class FrictionHeat(NamedTuple):
    """Friction heat into the oil, the innermost layer of the wall, the rod and the head [W]."""

    oil: Array
    layer: Array
    rod: Array
    head: Array


def friction_heat(*, piston_seal: Array, rod_seal: Array, in_oil: bool = False) -> FrictionHeat:
    """Where the friction heat of the seals goes.

    Heat of the piston's seals enters the innermost layer. Half the heat of the rod's seals enters
    the rod, half the head. With `in_oil`, all heat enters the oil: the other bound.

    Parameters
    ----------
    piston_seal, rod_seal : mean friction power of the seals [W]
    in_oil : whether all of it enters the oil [-]

    Returns
    -------
    heat into oil, innermost layer, rod and head [W]

    Notes
    -----
    Valid: mean over a cycle; the true split lies between the two bounds.

    References
    ----------
    [derived] seals conduct far worse than metal and wall (our choice of the halves)

    Examples
    --------
    >>> friction_heat(piston_seal=6.0, rod_seal=2.0)
    FrictionHeat(oil=0.0, layer=6.0, rod=1.0, head=1.0)
    """
    nothing = 0.0 * (piston_seal + rod_seal)
    if in_oil:
        return FrictionHeat(piston_seal + rod_seal, nothing, nothing, nothing)
    return FrictionHeat(nothing, piston_seal + nothing, 0.5 * rod_seal, 0.5 * rod_seal)
