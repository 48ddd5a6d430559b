"""Static contact pressure of a worn-in land: the face of a step ring or of a compact seal.

t = x/b is 0 at the sealed side, 1 at the outer one; pressures on one scale (gauge or absolute).
PTFE and elastomer faces wear and creep until their pressure is even, so the land carries the
falling oil pressure plus a flat excess; new sharp edges carry more for their first metres. A
negative excess says that the load is too small for this width: the sealed pressure would open the
contact, and the profile must not be used.
"""

from __future__ import annotations

from ..base.numeric import Array, geometry, positive, real, where

LAND_POWER = 8
"""Even power of the excess, 1 - u^8 (*choice*: flat within 5 % over the middle 69 %)."""


def land_profile(
    *, position: Array, sealed_pressure: Array, outer_pressure: Array, excess: Array
) -> Array:
    """Contact pressure of a worn-in land: the even fall of the oil pressure plus a flat excess.

    p = p_a + (p_s - p_a)(1 - t) + p_e (1 - u^8), u = 2 t - 1.

    Parameters
    ----------
    position : t = x/b, 0 to 1 [-]
    sealed_pressure, outer_pressure : p_s, p_a [Pa]
    excess : p_e [Pa]

    Returns
    -------
    contact pressure [Pa]

    Notes
    -----
    Valid: 0 <= t <= 1; run-in faces (new sharp edges carry more).

    References
    ----------
    [Archard1953] wear grows with pressure, so running evens the pressure out; [derived] edges that
    fall over the outer sixths

    Examples
    --------
    >>> p = land_profile(position=0.5, sealed_pressure=5e6, outer_pressure=0.0, excess=4e6)
    >>> print(f"{p / 1e6:.2f} MPa")
    6.50 MPa
    """
    fall = (sealed_pressure - outer_pressure) * (1 - position)
    return outer_pressure + fall + excess * (1 - (2 * position - 1) ** LAND_POWER)


@geometry
def land_excess(
    *, line_load: Array, width: Array, sealed_pressure: Array, outer_pressure: Array
) -> Array:
    """Excess with which the land profile carries a line load, (9/8)[f/b - (p_s - p_a)/2].

    Parameters
    ----------
    line_load : f over the outer pressure [N/m]
    width : b [m]
    sealed_pressure, outer_pressure : p_s, p_a [Pa]

    Returns
    -------
    excess [Pa]

    Notes
    -----
    Valid: result >= 0; NaN without width.

    References
    ----------
    [derived] mean of `land_profile` over t, solved for the excess

    Examples
    --------
    >>> p = land_excess(line_load=13e3, width=2e-3, sealed_pressure=5e6, outer_pressure=0.0)
    >>> print(f"{p / 1e6:.2f} MPa")
    4.50 MPa
    """
    mean = line_load / positive(width) - (sealed_pressure - outer_pressure) / 2
    return mean * (LAND_POWER + 1) / LAND_POWER


@geometry
def land_peak(
    *, line_load: Array, width: Array, sealed_pressure: Array, outer_pressure: Array
) -> Array:
    """Highest pressure of the land profile that carries a line load.

    At u = -min[((p_s - p_a)/(16 p_e))^(1/7), 1]; without excess the sealed pressure.

    Parameters
    ----------
    line_load : f over the outer pressure [N/m]
    width : b [m]
    sealed_pressure, outer_pressure : p_s, p_a [Pa]; p_s >= p_a

    Returns
    -------
    peak pressure, on the scale of the two [Pa]; the outer pressure without width (no contact)

    Notes
    -----
    Valid: as `land_profile`.

    References
    ----------
    [derived] maximum of `land_profile`

    Examples
    --------
    >>> p = land_peak(line_load=13e3, width=2e-3, sealed_pressure=5e6, outer_pressure=0.0)
    >>> print(f"{p / 1e6:.3f} MPa")
    8.494 MPa
    """
    touching = real(width) > 0
    excess = land_excess(
        line_load=line_load,
        width=where(touching, width, 1.0),
        sealed_pressure=sealed_pressure,
        outer_pressure=outer_pressure,
    )
    fall = real(sealed_pressure) - real(outer_pressure)
    steep = fall >= 2 * LAND_POWER * real(excess)
    ratio = where(steep, 1.0, fall / where(steep, 1.0, 2 * LAND_POWER * real(excess)))
    place = where(steep, 0.0, (1 - ratio ** (1 / (LAND_POWER - 1))) / 2)
    peak = land_profile(
        position=place,
        sealed_pressure=sealed_pressure,
        outer_pressure=outer_pressure,
        excess=excess,
    )
    return where(touching, peak, outer_pressure)
