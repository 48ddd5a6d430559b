"""Wilson's model of a hydraulic motor or pump: flow and shaft torque.

Motor and pump are one machine with two sign conventions. A motor counts flow and pressure
difference from inlet to outlet and delivers torque. A pump counts the pressure difference from
outlet to inlet and takes torque; its flow and torque are those of the motor at -dp, with the torque
reversed. Friction acts against the speed in every quadrant, so neither delivers more power than it
takes. The losses stay the same if the displacement setting is reduced. The source writes mu as nu
rho (`fluid.dynamic_viscosity`).
"""

from __future__ import annotations

import math

from ..base.numeric import Array, absolute, namespace, positive

SIGN_SPEED = 0.5
"""Speed w_0 in tanh(w/w_0), which replaces sgn w [rad/s] (our choice: 5 rpm, as Coulomb friction at
such low speeds is hardly known)."""


def motor_flow(
    *,
    speed: Array,
    pressure_difference: Array,
    displacement: Array,
    dynamic_viscosity: Array,
    slip_coefficient: Array,
    setting: Array = 1.0,
) -> Array:
    """Flow into a motor, q = eps V_r w + C_s V_r dp/mu, V_r = V/(2 pi).

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


def pump_flow(
    *,
    speed: Array,
    pressure_difference: Array,
    displacement: Array,
    dynamic_viscosity: Array,
    slip_coefficient: Array,
    setting: Array = 1.0,
) -> Array:
    """Flow out of a pump, q = eps V_r w - C_s V_r dp/mu, V_r = V/(2 pi).

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
