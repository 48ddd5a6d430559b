"""The load on the oil spring in closed form: frequency and shares of the damping ratio."""

from __future__ import annotations

import math

from ..geometry import geometry
from ..numeric import Array, namespace, real, where


def natural_frequency(*, stiffness: Array, mass: Array) -> Array:
    """Natural frequency of a mass on the actuator, f = sqrt(k/m)/(2 pi).

    Parameters
    ----------
    stiffness : axial stiffness with rod and mounting [N/m]
    mass : load, rod and piston, reflected to the rod [kg]

    Returns
    -------
    frequency [Hz]; NaN at mass <= 0 or stiffness < 0

    Notes
    -----
    Valid: one degree of freedom, ports closed.

    References
    ----------
    [Merritt1967] hydraulic natural frequency

    Examples
    --------
    >>> print(f"{natural_frequency(stiffness=20.6583e6, mass=30.0):.3f}")
    132.071
    """
    valid = (real(mass) > 0) & (real(stiffness) >= 0)
    square = where(valid, stiffness, 1.0) / where(valid, mass, 1.0)
    return where(valid, (0.5 / math.pi) * namespace(square).sqrt(square), math.nan)


def friction_damping_ratio(*, incremental_damping: Array, stiffness: Array, mass: Array) -> Array:
    """Share of the damping ratio from friction, B_inc/(2 sqrt(k m)).

    Parameters
    ----------
    incremental_damping : dF_fr/dv at the stated speed [N s/m]; negative on the falling Stribeck
        branch (stick-slip). Never the secant F/v.
    stiffness : [N/m]
    mass : [kg]

    Returns
    -------
    damping ratio [-]; NaN where k m <= 0

    Notes
    -----
    Valid: small vibration about a steady sliding speed.

    References
    ----------
    [derived] linear oscillator

    Examples
    --------
    >>> zeta = friction_damping_ratio(incremental_damping=400.0, stiffness=20.6583e6, mass=30.0)
    >>> print(f"{zeta:.6f}")
    0.008034
    """
    product = stiffness * mass
    valid = real(product) > 0
    safe = where(valid, product, 1.0)
    return where(valid, 0.5 * incremental_damping / namespace(safe).sqrt(safe), math.nan)


@geometry
def conductance_damping_ratio(
    *,
    stiffness: Array,
    mass: Array,
    area_a: Array,
    compliance_a: Array,
    conductance_a: Array,
    area_b: Array,
    compliance_b: Array,
    conductance_b: Array,
) -> Array:
    """Share of the damping ratio from leakage and valve conductance.

    (1/(2 omega k_h)) sum (A_i^2/C_i)(G_i/C_i), omega = sqrt(k/m), k_h = sum A_i^2/C_i.

    Parameters
    ----------
    stiffness : [N/m], of omega; k_h unless rod and mounting matter
    mass : [kg]
    area_a, area_b : [m^2]
    compliance_a, compliance_b : [m^3/Pa]
    conductance_a, conductance_b : G = dq/dp out of each chamber [m^3/s/Pa]

    Returns
    -------
    damping ratio [-]; NaN where k m <= 0

    Notes
    -----
    Valid: G/(omega C) much smaller than one.

    References
    ----------
    [derived] first-order perturbation of m s^2 + sum A_i^2 s/(C_i s + G_i) = 0

    Examples
    --------
    >>> zeta = conductance_damping_ratio(stiffness=1e7, mass=10.0, area_a=5e-4, area_b=5e-4,
    ...     compliance_a=5e-14, compliance_b=5e-14, conductance_a=1e-12, conductance_b=1e-12)
    >>> print(f"{zeta:.4f}")
    0.0100
    """
    valid = (real(stiffness) > 0) & (real(mass) > 0)
    square = where(valid, stiffness, 1.0) / where(valid, mass, 1.0)
    omega = namespace(square).sqrt(square)
    side_a = area_a * area_a / compliance_a
    side_b = area_b * area_b / compliance_b
    leak = side_a * conductance_a / compliance_a + side_b * conductance_b / compliance_b
    return where(valid, 0.5 * leak / (omega * (side_a + side_b)), math.nan)
