"""Dynamics of the load on the oil spring, in closed form."""

from __future__ import annotations

import math

from ..base.numeric import Array, namespace, real, where


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
