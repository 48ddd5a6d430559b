"""Size of the supply of a duty cycle: flows, power, heat and masses.

The pump delivers the mean flow of a cycle, and an accumulator of
`accumulator.gas_volume_needed` delivers the rest. Without accumulator the pump delivers the peak.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

from ..base.dataclass import dataclass
from ..base.numeric import (
    Array,
    geometry,
    histories,
    namespace,
    over_time,
    positive,
    real,
)


class Ripple(NamedTuple):
    """Volume that flows in and out of an accumulator in a cycle.

    Attributes
    ----------
    volume : largest minus smallest volume taken beyond the mean [m^3]
    largest, smallest : indices of the samples of both [-]
    """

    volume: Array
    largest: Array
    smallest: Array


def ripple_volume(*, time: Array | Sequence[Array], flow: Array | Sequence[Array]) -> Ripple:
    """Volume that an accumulator must deliver while the pump delivers the mean flow.

    dV = max - min over a period of the integral of (q - q_mean) dt, by the trapezoid rule: the
    mass-curve method of reservoirs. The slope of dV is exact at the two samples.

    Parameters
    ----------
    time : at the samples, rising, on the first axis [s]
    flow : q of a closed cycle at the samples [m^3/s]

    Returns
    -------
    volume and the indices of its largest and smallest integral [m^3, -, -], without the time axis

    Notes
    -----
    Valid: closed cycles; the extremes of the integral between samples are left out.

    The volume of a sine is too small by up to 8/n^2 for n samples: 2 % for 20, 0.1 % for 100.

    References
    ----------
    [Rippl1883] mass curve of a reservoir

    Examples
    --------
    >>> ripple = ripple_volume(time=[0.0, 0.2, 0.5, 0.7, 1.0],
    ...                        flow=[1e-5, 6e-5, 3e-5, 0.5e-5, 1e-5])
    >>> print(f"{ripple.volume * 1e6:.3f} cm3, samples {ripple.largest} and {ripple.smallest}")
    7.375 cm3, samples 2 and 0
    """
    t, q = histories(time, flow)
    xp = namespace(t, q)
    excess = q - over_time(q, t) / (t[-1, ...] - t[0, ...])
    steps = 0.5 * (excess[1:, ...] + excess[:-1, ...]) * (t[1:, ...] - t[:-1, ...])
    # the integral after the last sample is zero again: it repeats the first
    taken = xp.concat([0 * steps[:1, ...], xp.cumulative_sum(steps, axis=0)[:-1, ...]], axis=0)
    largest = xp.argmax(real(taken), axis=0, keepdims=True)
    smallest = xp.argmin(real(taken), axis=0, keepdims=True)
    span = xp.take_along_axis(taken, largest, axis=0) - xp.take_along_axis(taken, smallest, axis=0)
    return Ripple(span[0, ...], largest[0, ...], smallest[0, ...])


def electric_power(
    *, hydraulic_power: Array, pump_efficiency: Array, motor_efficiency: Array
) -> Array:
    """Electric power of the pump's motor, P_e = P_h/(eta_p eta_m).

    Parameters
    ----------
    hydraulic_power : P_h, supply energy of a cycle divided by its period [W]
    pump_efficiency, motor_efficiency : eta_p, eta_m, total [-], > 0

    Returns
    -------
    electric power [W]; NaN where an efficiency is not positive

    Notes
    -----
    Valid: efficiencies at the operating point.

    References
    ----------
    [derived] definition of the efficiencies

    Examples
    --------
    >>> p = electric_power(hydraulic_power=1043.0, pump_efficiency=0.85, motor_efficiency=0.9)
    >>> print(f"{p:.2f} W")
    1363.40 W
    """
    return hydraulic_power / (positive(pump_efficiency) * positive(motor_efficiency))


def oil_heat(*, hydraulic_power: Array, pump_efficiency: Array, net_work_rate: Array) -> Array:
    """Heat that a closed oil circuit must give off, P_h/eta_p - (W_out - W_in)/T.

    Work that the load does on the actuator also becomes heat.

    Parameters
    ----------
    hydraulic_power : P_h, supply energy of a cycle divided by its period [W]
    pump_efficiency : eta_p, total [-], > 0; the motor's heat is not in the oil
    net_work_rate : (W_out - W_in)/T, mean power to the load; negative if the load drives [W]

    Returns
    -------
    heat [W]; NaN where the efficiency is not positive

    Notes
    -----
    Valid: all losses of pump, valve and actuator go into the oil.

    References
    ----------
    [derived] energy balance over a closed cycle

    Examples
    --------
    >>> q = oil_heat(hydraulic_power=1043.0, pump_efficiency=0.85, net_work_rate=-8.3)
    >>> print(f"{q:.2f} W")
    1235.36 W
    """
    return hydraulic_power / positive(pump_efficiency) - net_work_rate


def tank_temperature(
    *, heat: Array, cooler_conductance: Array, ambient_temperature: Array
) -> Array:
    """Steady temperature of the tank, T = T_a + heat/(U A).

    Parameters
    ----------
    heat : from `oil_heat` [W]
    cooler_conductance : U A of cooler and tank [W/K], > 0
    ambient_temperature : T_a [K]

    Returns
    -------
    temperature [K]; NaN where the conductance is not positive

    Notes
    -----
    Valid: steady state, mixed tank.

    References
    ----------
    [derived] energy balance

    Examples
    --------
    >>> t = tank_temperature(heat=1235.36, cooler_conductance=30.0, ambient_temperature=293.15)
    >>> print(f"{t - 273.15:.2f} degC")
    61.18 degC
    """
    return ambient_temperature + heat / positive(cooler_conductance)


def cooler_conductance_needed(
    *, heat: Array, temperature: Array, ambient_temperature: Array
) -> Array:
    """Conductance of a cooler that keeps the tank at a temperature, U A = heat/(T - T_a).

    Parameters
    ----------
    heat : from `oil_heat` [W]
    temperature, ambient_temperature : T of the tank and T_a [K], T > T_a

    Returns
    -------
    conductance [W/K]; NaN where the tank is not warmer than the air

    Notes
    -----
    Valid: steady state, mixed tank.

    References
    ----------
    [derived] `tank_temperature` solved for U A

    Examples
    --------
    >>> g = cooler_conductance_needed(heat=1235.36, temperature=334.33,
    ...                               ambient_temperature=293.15)
    >>> print(f"{g:.1f} W/K")
    30.0 W/K
    """
    return heat / positive(temperature - ambient_temperature)


@geometry
def supply_masses(
    *,
    gas_volume: Array,
    pump_power: Array,
    cooler_conductance: Array,
    energy: Array,
    accumulator_density: Array | None,
    pump_specific_mass: Array | None,
    cooler_specific_mass: Array | None,
    specific_energy: Array | None,
) -> dict[str, Array | None]:
    """Masses of the parts of a supply, each its size times a specific mass.

    The mass of the source is energy/specific energy. A part without specific mass has no mass:
    None, never zero.

    Parameters
    ----------
    gas_volume : of the accumulator, from `accumulator.gas_volume_needed` [m^3]
    pump_power : hydraulic output of the pump at its rated point [W]
    cooler_conductance : U A [W/K]
    energy : taken from the source in a mission [J]
    accumulator_density : mass per gas volume [kg/m^3], or None
    pump_specific_mass : mass of pump and motor per output power [kg/W], or None
    cooler_specific_mass : mass per conductance [kg K/W], or None
    specific_energy : of the source [J/kg], or None

    Returns
    -------
    mass [kg] or None of `accumulator`, `pump`, `cooler` and `source`

    Notes
    -----
    Valid: specific masses of the maker, at this size and pressure.

    Orders (recalled, not verified): composite accumulator 1 to 2 kg/l at 210 bar, pump with motor
    0.5 to 2 kg/kW, cooler 0.02 to 0.05 kg per W/K, lithium-ion battery 0.5 to 0.7 MJ/kg.

    References
    ----------
    [derived] definition of the specific masses

    Examples
    --------
    >>> masses = supply_masses(gas_volume=0.12e-3, pump_power=1000.0, cooler_conductance=30.0,
    ...     energy=9e6, accumulator_density=1500.0, pump_specific_mass=1e-3,
    ...     cooler_specific_mass=None, specific_energy=0.6e6)
    >>> masses
    {'accumulator': 0.18, 'pump': 1.0, 'cooler': None, 'source': 15.0}
    """
    sizes = {
        "accumulator": (gas_volume, accumulator_density),
        "pump": (pump_power, pump_specific_mass),
        "cooler": (cooler_conductance, cooler_specific_mass),
    }
    masses = {part: None if mass is None else size * mass for part, (size, mass) in sizes.items()}
    source = None if specific_energy is None else energy / positive(specific_energy)
    return {**masses, "source": source}


@dataclass(frozen=True, slots=True)
class SystemMass:
    """Mass of a hydraulic system and of its parts.

    Attributes
    ----------
    parts : mass of each part, or None if unknown [kg]
    missing : parts of unknown mass
    total : sum of all parts, or None while a part is missing [kg]
    """

    parts: dict[str, Array | None]
    missing: tuple[str, ...]
    total: Array | None


def system_mass(*, parts: Mapping[str, Array | None]) -> SystemMass:
    """Mass of a hydraulic system: actuators, lines with oil, and the parts of the supply.

    Parameters
    ----------
    parts : mass of each part by its name, None if unknown [kg]; those of the supply from
        `supply_masses`

    Returns
    -------
    total, parts, and the names of the missing parts [kg]; no total while a part is missing

    Notes
    -----
    Valid: parts do not overlap.

    References
    ----------
    [derived] sum

    Examples
    --------
    >>> system_mass(parts={"actuators": 1.25, "pump": None, "cooler": None}).missing
    ('pump', 'cooler')
    >>> system_mass(parts={"actuators": 1.25, "pump": 1.0}).total
    2.25
    """
    missing = tuple(name for name, mass in parts.items() if mass is None)
    total = None if missing else sum(mass for mass in parts.values() if mass is not None)
    return SystemMass(dict(parts), missing, total)
