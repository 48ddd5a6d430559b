"""Netting: pressure carried by fibres alone, a limit check on every wound tube."""

from __future__ import annotations

from collections.abc import Sequence
from math import pi

from ..geometry import geometry
from ..numeric import Array, maximum, namespace


@geometry
def netting(
    *,
    pressure: Array,
    radius: Array,
    angle: Array,
    helical_stress: Array,
    hoop_stress: Array,
) -> tuple[Array, Array]:
    """Thickness of fibres alone that carries a closed tube's pressure.

    t_helical = p R/(2 s cos^2 a), t_hoop = p R (1 - tan^2(a)/2)/s.

    Parameters
    ----------
    pressure : internal gauge pressure [Pa]
    radius : wall radius [m]
    angle : winding angle of the helical fibres from the tube axis [rad]
    helical_stress, hoop_stress : fibre stresses at that pressure [Pa]

    Returns
    -------
    thickness of the helical and of the hoop layers [m]; no hoop layer is needed at
    `netting_angle`, and its value is negative beyond

    Notes
    -----
    Valid: as a limit check; the matrix carries nothing.

    References
    ----------
    [derived] equilibrium of N_z = p R/2 and N_t = p R by fibres

    Examples
    --------
    >>> helical, hoop = netting(pressure=28e6, radius=16e-3, angle=0.6108652381980153,
    ...                         helical_stress=1.4e9, hoop_stress=1.4e9)
    >>> print(f"{helical * 1e3:.6f} {hoop * 1e3:.6f}")
    0.238446 0.241554
    """
    xp = namespace(angle)
    cosine, tangent = xp.cos(angle), xp.tan(angle)
    line = pressure * radius
    return (
        line / (2 * helical_stress * cosine * cosine),
        line * (1 - tangent * tangent / 2) / hoop_stress,
    )


def netting_angle(*, line_force_ratio: Array = 2.0) -> Array:
    """Winding angle at which one pair of fibres alone carries the tube.

    tan^2 a = N_t/N_z: 54.74 degrees for a closed tube.

    Parameters
    ----------
    line_force_ratio : N_t/N_z [-]; 2 is closed

    Returns
    -------
    angle from the tube axis [rad]

    Notes
    -----
    Valid: as a limit check; the matrix carries nothing.

    References
    ----------
    [derived] equilibrium of N_z = f cos^2 a and N_t = f sin^2 a by fibres

    Examples
    --------
    >>> print(f"{netting_angle() * 180 / pi:.2f}")
    54.74
    """
    xp = namespace(line_force_ratio)
    return xp.atan(xp.sqrt(line_force_ratio))


@geometry
def netting_burst_pressure(
    *,
    angles: Sequence[Array],
    thicknesses: Sequence[Array],
    fibre_strengths: Sequence[Array],
    radius: Array,
    axial_force_per_pressure: Array,
) -> Array:
    """Pressure at which all fibres at full strength together just balance the tube.

    p = min(sum X t sin^2 a/R, sum X t cos^2 a/n_z), n_z = (N/p)/(2 pi R): no laminate of these
    fibres whose matrix is cracked can burst above it.

    Parameters
    ----------
    angles : winding angle of each layer [rad]
    thicknesses : thickness of each layer [m]
    fibre_strengths : fibre-direction tensile strength of each layer [Pa]
    radius : wall radius [m]
    axial_force_per_pressure : N/p [m^2]; pi R^2 is closed

    Returns
    -------
    pressure [Pa]

    Notes
    -----
    Valid: as a limit check; needs some fibre each way.

    References
    ----------
    [derived] plastic limit of the fibre net

    Examples
    --------
    >>> p = netting_burst_pressure(angles=[0.9553166181245093], thicknesses=[1e-3],
    ...                            fibre_strengths=[1.5e9], radius=20e-3,
    ...                            axial_force_per_pressure=pi * 20e-3**2)
    >>> print(f"{p / 1e6:.2f} MPa")
    50.00 MPa
    """
    axial: Array = 0.0
    hoop: Array = 0.0
    for angle, thickness, strength in zip(angles, thicknesses, fibre_strengths, strict=True):
        cosine = namespace(angle).cos(angle)
        force, share = strength * thickness, cosine * cosine
        axial = axial + force * share
        hoop = hoop + force * (1 - share)
    axial_line = axial_force_per_pressure / (2 * pi * radius)
    return 1 / maximum(radius / hoop, axial_line / axial)
