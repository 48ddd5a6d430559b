"""Wilson's model of a hydraulic motor or pump: flow, shaft torque and efficiencies.

One machine, two directions of counting. A motor counts flow and pressure difference from inlet to
outlet and gives torque; a pump counts pressure difference from outlet to inlet and takes torque:
its flow and torque are those of the motor at -dp, the torque reversed. The friction works against
the speed in every quadrant, so neither gives more power than it takes. Losses do not shrink with
the setting. The slides write mu as nu rho (`fluid.dynamic_viscosity`).
"""

from __future__ import annotations

import math
from typing import NamedTuple

from ..numeric import Array, absolute, namespace, positive, real, where

SIGN_SPEED = 0.5
"""w_0 of tanh(w/w_0) for sgn w, rad/s (a choice: 5 rpm, where Coulomb friction is ill known)."""


class Efficiency(NamedTuple):
    """Efficiencies of a motor or pump [-]: of flow, of torque, and of power, their product."""

    volumetric: Array
    hydromechanical: Array
    total: Array


def motor_flow(
    *,
    speed: Array,
    pressure_difference: Array,
    displacement: Array,
    dynamic_viscosity: Array,
    slip_coefficient: Array,
    setting: Array = 1.0,
) -> Array:
    """Flow into a motor, q = eps V_r w + C_s V_r dp/mu, V_r = V/2 pi.

    Parameters
    ----------
    speed : w of the shaft, either sign [rad/s]
    pressure_difference : dp, inlet less outlet, either sign [Pa]
    displacement : V at full setting [m^3 per revolution]
    dynamic_viscosity : mu [Pa s], > 0
    slip_coefficient : C_s [-]
    setting : eps, share of the displacement, -1 to 1 [-]

    Returns
    -------
    flow from inlet to outlet [m^3/s]; NaN where the viscosity is not positive

    Notes
    -----
    Valid: laminar leakage between the ports; no case drain, no cavitation, oil incompressible.

    References
    ----------
    [MECE5005] performance of pumps and motors; [Wilson1950]

    Examples
    --------
    >>> q = motor_flow(speed=104.72, pressure_difference=100e5, displacement=13.3e-6,
    ...     dynamic_viscosity=32e-6 * 870, slip_coefficient=150e-9)
    >>> print(f"{q * 60000:.2f} l/min")
    20.14 l/min
    """
    radian = displacement / (2 * math.pi)
    leakage = slip_coefficient * pressure_difference / positive(dynamic_viscosity)
    return radian * (setting * speed + leakage)


def motor_torque(
    *,
    speed: Array,
    pressure_difference: Array,
    displacement: Array,
    dynamic_viscosity: Array,
    coulomb_coefficient: Array,
    viscous_coefficient: Array,
    constant_torque: Array,
    setting: Array = 1.0,
    sign_speed: Array = SIGN_SPEED,
) -> Array:
    """Torque a motor gives, T = eps V_r dp - tanh(w/w_0) (C_f V_r |dp| + T_c) - C_v mu V_r w.

    Parameters
    ----------
    speed : w of the shaft, either sign [rad/s]
    pressure_difference : dp, inlet less outlet, either sign [Pa]
    displacement : V = 2 pi V_r at full setting [m^3 per revolution]
    dynamic_viscosity : mu [Pa s]
    coulomb_coefficient : C_f [-]
    viscous_coefficient : C_v [-]
    constant_torque : T_c, loss [N m]
    setting : eps, share of the displacement, -1 to 1 [-]
    sign_speed : w_0 [rad/s], > 0

    Returns
    -------
    torque in the direction of positive speed [N m]

    Notes
    -----
    Valid: |w| above some w_0; near rest the friction fades out, there is no breakaway torque.

    References
    ----------
    [MECE5005] performance of pumps and motors; [Wilson1950]; [derived] smoothing of the sign

    Examples
    --------
    >>> t = motor_torque(speed=104.72, pressure_difference=100e5, displacement=13.3e-6,
    ...     dynamic_viscosity=32e-6 * 870, coulomb_coefficient=0.16, viscous_coefficient=100e3,
    ...     constant_torque=0.1)
    >>> print(f"{t:.2f} N m")
    17.06 N m
    """
    radian = displacement / (2 * math.pi)
    ratio = speed / sign_speed
    friction = coulomb_coefficient * radian * absolute(pressure_difference) + constant_torque
    viscous = viscous_coefficient * dynamic_viscosity * radian * speed
    ideal = setting * radian * pressure_difference
    return ideal - namespace(ratio).tanh(ratio) * friction - viscous


def motor_efficiency(
    *,
    speed: Array,
    pressure_difference: Array,
    displacement: Array,
    flow: Array,
    torque: Array,
    setting: Array = 1.0,
) -> Efficiency:
    """Efficiencies of a motor, eta_v = eps V_r w/q, eta_hm = T/(eps V_r dp), total T w/(q dp).

    Parameters
    ----------
    speed : w of the shaft [rad/s]
    pressure_difference : dp, inlet less outlet [Pa]
    displacement : V = 2 pi V_r at full setting [m^3 per revolution]
    flow : q, from `motor_flow` or measured [m^3/s]
    torque : T, from `motor_torque` or measured [N m]
    setting : eps, share of the displacement, -1 to 1 [-]

    Returns
    -------
    volumetric, hydromechanical and total efficiency [-]; NaN where it does not work as a motor

    Notes
    -----
    Valid: q dp > 0 (it takes hydraulic power) and T w >= 0 (the shaft is not driven).

    References
    ----------
    [MECE5005] performance of pumps and motors

    Examples
    --------
    >>> eta = motor_efficiency(speed=104.72, pressure_difference=100e5, displacement=13.3e-6,
    ...     flow=20.143 / 60000, torque=17.064)
    >>> print(" ".join(f"{value:.3f}" for value in eta))
    0.660 0.806 0.532
    """
    swept = setting * displacement / (2 * math.pi)
    shaft, oil = torque * speed, flow * pressure_difference
    works = (real(oil) > 0) & (real(shaft) >= 0) & (real(swept) != 0)
    return Efficiency(
        _share(works, swept * speed, flow),
        _share(works, torque, swept * pressure_difference),
        _share(works, shaft, oil),
    )


def pump_flow(
    *,
    speed: Array,
    pressure_difference: Array,
    displacement: Array,
    dynamic_viscosity: Array,
    slip_coefficient: Array,
    setting: Array = 1.0,
) -> Array:
    """Flow out of a pump, q = eps V_r w - C_s V_r dp/mu, V_r = V/2 pi.

    Parameters
    ----------
    speed : w of the shaft, either sign [rad/s]
    pressure_difference : dp, outlet less inlet, either sign [Pa]
    displacement : V at full setting [m^3 per revolution]
    dynamic_viscosity : mu [Pa s], > 0
    slip_coefficient : C_s [-]
    setting : eps, share of the displacement, -1 to 1 [-]

    Returns
    -------
    flow from inlet to outlet [m^3/s]; NaN where the viscosity is not positive

    Notes
    -----
    Valid: laminar leakage between the ports; no case drain, no cavitation, oil incompressible.

    References
    ----------
    [MECE5005] performance of pumps and motors; [Wilson1950]

    Examples
    --------
    >>> q = pump_flow(speed=104.72, pressure_difference=100e5, displacement=13.3e-6,
    ...     dynamic_viscosity=32e-6 * 870, slip_coefficient=150e-9)
    >>> print(f"{q * 60000:.2f} l/min")
    6.46 l/min
    """
    return motor_flow(
        speed=speed,
        pressure_difference=-pressure_difference,
        displacement=displacement,
        dynamic_viscosity=dynamic_viscosity,
        slip_coefficient=slip_coefficient,
        setting=setting,
    )


def pump_torque(
    *,
    speed: Array,
    pressure_difference: Array,
    displacement: Array,
    dynamic_viscosity: Array,
    coulomb_coefficient: Array,
    viscous_coefficient: Array,
    constant_torque: Array,
    setting: Array = 1.0,
    sign_speed: Array = SIGN_SPEED,
) -> Array:
    """Torque a pump takes, T = eps V_r dp + tanh(w/w_0) (C_f V_r |dp| + T_c) + C_v mu V_r w.

    Parameters
    ----------
    speed : w of the shaft, either sign [rad/s]
    pressure_difference : dp, outlet less inlet, either sign [Pa]
    displacement : V = 2 pi V_r at full setting [m^3 per revolution]
    dynamic_viscosity : mu [Pa s]
    coulomb_coefficient : C_f [-]
    viscous_coefficient : C_v [-]
    constant_torque : T_c, loss [N m]
    setting : eps, share of the displacement, -1 to 1 [-]
    sign_speed : w_0 [rad/s], > 0

    Returns
    -------
    torque on the shaft in the direction of positive speed [N m]

    Notes
    -----
    Valid: |w| above some w_0; near rest the friction fades out, there is no breakaway torque.

    References
    ----------
    [MECE5005] performance of pumps and motors; [Wilson1950]; [derived] smoothing of the sign

    Examples
    --------
    >>> t = pump_torque(speed=104.72, pressure_difference=100e5, displacement=13.3e-6,
    ...     dynamic_viscosity=32e-6 * 870, coulomb_coefficient=0.16, viscous_coefficient=100e3,
    ...     constant_torque=0.1)
    >>> print(f"{t:.2f} N m")
    25.27 N m
    """
    return -motor_torque(
        speed=speed,
        pressure_difference=-pressure_difference,
        displacement=displacement,
        dynamic_viscosity=dynamic_viscosity,
        coulomb_coefficient=coulomb_coefficient,
        viscous_coefficient=viscous_coefficient,
        constant_torque=constant_torque,
        setting=setting,
        sign_speed=sign_speed,
    )


def pump_efficiency(
    *,
    speed: Array,
    pressure_difference: Array,
    displacement: Array,
    flow: Array,
    torque: Array,
    setting: Array = 1.0,
) -> Efficiency:
    """Efficiencies of a pump, eta_v = q/(eps V_r w), eta_hm = eps V_r dp/T, total q dp/(T w).

    Parameters
    ----------
    speed : w of the shaft [rad/s]
    pressure_difference : dp, outlet less inlet [Pa]
    displacement : V = 2 pi V_r at full setting [m^3 per revolution]
    flow : q, from `pump_flow` or measured [m^3/s]
    torque : T, from `pump_torque` or measured [N m]
    setting : eps, share of the displacement, -1 to 1 [-]

    Returns
    -------
    volumetric, hydromechanical and total efficiency [-]; NaN where it does not work as a pump

    Notes
    -----
    Valid: T w > 0 (the shaft is driven) and q dp >= 0 (it takes no hydraulic power).

    References
    ----------
    [MECE5005] performance of pumps and motors

    Examples
    --------
    >>> eta = pump_efficiency(speed=104.72, pressure_difference=100e5, displacement=13.3e-6,
    ...     flow=6.457 / 60000, torque=25.271)
    >>> print(" ".join(f"{value:.3f}" for value in eta))
    0.485 0.838 0.407
    """
    swept = setting * displacement / (2 * math.pi)
    shaft, oil = torque * speed, flow * pressure_difference
    works = (real(shaft) > 0) & (real(oil) >= 0) & (real(swept) != 0)
    return Efficiency(
        _share(works, flow, swept * speed),
        _share(works, swept * pressure_difference, torque),
        _share(works, oil, shaft),
    )


def _share(works: Array, part: Array, whole: Array) -> Array:
    """`part` of `whole` where the machine works, NaN elsewhere."""
    return where(works, part, math.nan) / where(works, whole, 1.0)
