"""One-way flow-control valve: a needle that throttles, with a check valve beside it.

The pressure difference is chamber pressure minus line pressure. If it is positive, oil flows
out of the chamber through the needle only. If it is negative, oil flows into the chamber through
the needle and, above the cracking pressure, through the check valve too.
"""

from __future__ import annotations

import math

from ..base.numeric import Array, absolute, clip, geometry, maximum, minimum, namespace, real, where
from .orifice import orifice_conductance, orifice_flow, orifice_pressure_drop

NEEDLE_AREA = 0.22e-4
"""Effective area of the fully open needle, m^2 [AaltoThesis] section 3.1."""
CHECK_AREA = 0.64e-4
"""Effective area of free flow, m^2 [AaltoThesis] section 3.1; assumed to be
that of the check valve's poppet alone (our choice)."""
CRACKING_PRESSURE = 0.4e5
"""Pressure difference that opens the check valve, Pa [AaltoThesis] section 3.3.5."""
OPENING_SPAN = 0.1e5
"""Pressure rise from cracking to fully open, Pa. Our choice: after a share w of this rise, the open
share of the area is w^2 (3 - 2 w)."""
_STEPS = 80
_TOLERANCE = 1e-12


@geometry
def one_way_flow(
    *,
    pressure_difference: Array,
    density: Array,
    dynamic_viscosity: Array,
    opening: Array = 1.0,
    needle_area: Array = NEEDLE_AREA,
    check_area: Array = CHECK_AREA,
    cracking_pressure: Array = CRACKING_PRESSURE,
    opening_span: Array = OPENING_SPAN,
) -> Array:
    """Flow out of the chamber, q_needle(dp) + w^2 (3 - 2 w) q_check(dp).

    w rises from 0 at dp = -cracking_pressure to 1 at dp = -(cracking_pressure + opening span).

    Parameters
    ----------
    pressure_difference : chamber minus line [Pa], either sign
    density : [kg/m^3]
    dynamic_viscosity : [Pa s]
    opening : open share of the needle's area, 0 to 1 [-]
    needle_area, check_area : when fully open [m^2]
    cracking_pressure, opening_span : [Pa]

    Returns
    -------
    flow [m^3/s], positive out of the chamber (throttled)

    Notes
    -----
    Valid: changes slower than the poppet, which responds within about 1 ms.

    References
    ----------
    [AaltoThesis] eq. 9, sections 2.1.5 and 3.1

    Examples
    --------
    >>> oil = dict(density=870.0, dynamic_viscosity=0.04)
    >>> for dp in (1e5, -1e5):
    ...     print(f"{one_way_flow(pressure_difference=dp, **oil) * 60000:.2f} l/min")
    12.18 l/min
    -47.66 l/min
    """
    oil = {"density": density, "dynamic_viscosity": dynamic_viscosity}
    needle = {"area": opening * needle_area, **oil}
    share, _ = _opened(pressure_difference, cracking_pressure, opening_span)
    inward = minimum(pressure_difference, 0.0)
    free = orifice_flow(area=check_area, pressure_difference=inward, **oil)
    return orifice_flow(pressure_difference=pressure_difference, **needle) + share * free


@geometry
def one_way_conductance(
    *,
    pressure_difference: Array,
    density: Array,
    dynamic_viscosity: Array,
    opening: Array = 1.0,
    needle_area: Array = NEEDLE_AREA,
    check_area: Array = CHECK_AREA,
    cracking_pressure: Array = CRACKING_PRESSURE,
    opening_span: Array = OPENING_SPAN,
) -> Array:
    """Small-signal conductance dq/d(dp) of the valve at a pressure difference.

    At an operating flow, take the pressure difference from `one_way_pressure_drop`.

    Parameters
    ----------
    pressure_difference : mean value, chamber minus line [Pa], either sign
    density : [kg/m^3]
    dynamic_viscosity : [Pa s]
    opening : open share of the needle's area, 0 to 1 [-]
    needle_area, check_area : when fully open [m^2]
    cracking_pressure, opening_span : [Pa]

    Returns
    -------
    conductance [m^3/s/Pa]; 0 in the throttled direction of a closed needle

    Notes
    -----
    Valid: amplitudes that do not open or close the check valve.

    References
    ----------
    [derived] slope of `one_way_flow`

    Examples
    --------
    >>> oil = dict(density=870.0, dynamic_viscosity=0.04)
    >>> for dp in (1e5, -1e5):
    ...     print(f"{one_way_conductance(pressure_difference=dp, **oil):.3e}")
    1.019e-09
    3.983e-09
    >>> print(f"{one_way_conductance(pressure_difference=1e5, opening=0.0, **oil):.1f}")
    0.0
    """
    oil = {"density": density, "dynamic_viscosity": dynamic_viscosity}
    share, slope = _opened(pressure_difference, cracking_pressure, opening_span)
    check = {"area": check_area, "pressure_difference": minimum(pressure_difference, 0.0), **oil}
    free = share * orifice_conductance(**check) + slope * orifice_flow(**check)
    needle = {"area": opening * needle_area, "pressure_difference": pressure_difference, **oil}
    return orifice_conductance(**needle) + free


@geometry
def one_way_pressure_drop(
    *,
    flow: Array,
    density: Array,
    dynamic_viscosity: Array,
    opening: Array = 1.0,
    needle_area: Array = NEEDLE_AREA,
    check_area: Array = CHECK_AREA,
    cracking_pressure: Array = CRACKING_PRESSURE,
    opening_span: Array = OPENING_SPAN,
) -> Array:
    """Pressure drop of the valve at a flow, through the needle alone or through both paths.

    Outward flow passes only the needle. If inward flow opens the check valve, the drop lies
    between the cracking pressure and the larger of two pressures: that at which the check valve is
    fully open, and the drop if all the oil took the fully open check valve.
    Bracketed Newton steps solve the monotone flow balance; the last step adds the derivatives.

    Parameters
    ----------
    flow : [m^3/s], positive out of the chamber (throttled)
    density : [kg/m^3]
    dynamic_viscosity : [Pa s]
    opening : open share of the needle's area, 0 to 1 [-]
    needle_area, check_area : when fully open [m^2]; check_area > 0
    cracking_pressure, opening_span : [Pa]

    Returns
    -------
    pressure difference, chamber minus line [Pa]; infinite for flow out through a closed needle

    Notes
    -----
    Valid: changes slower than the poppet, which responds within about 1 ms.

    References
    ----------
    [AaltoThesis] eq. 9, sections 2.1.5 and 3.1; [derived] inverse of `one_way_flow`

    Examples
    --------
    >>> oil = dict(density=870.0, dynamic_viscosity=0.04)
    >>> for flow in (10 / 60000, -10 / 60000):
    ...     print(f"{one_way_pressure_drop(flow=flow, **oil) / 1e5:.3f} bar")
    0.676 bar
    -0.419 bar
    """
    oil = {"density": density, "dynamic_viscosity": dynamic_viscosity}
    needle = opening * needle_area
    blocked = real(needle) <= 0
    size = absolute(flow)
    alone = orifice_pressure_drop(area=where(blocked, 1.0, needle), flow=size, **oil)
    alone = where(blocked & (real(size) > 0), math.inf, alone)
    outward = real(flow) >= 0
    solved = (real(flow) < 0) & (real(alone) > real(cracking_pressure))
    if not namespace(solved).any(solved):
        return where(outward, alone, -alone)
    wanted = where(solved, size, 1.0)
    valve = {
        "opening": opening, "needle_area": needle_area, "check_area": check_area,
        "cracking_pressure": cracking_pressure, "opening_span": opening_span, **oil,
    }  # fmt: skip
    drop = _inward_drop(real(wanted), {name: real(value) for name, value in valve.items()})
    missing = wanted + one_way_flow(pressure_difference=-drop, **valve)
    drop = drop + missing / one_way_conductance(pressure_difference=-drop, **valve)
    return where(outward, alone, where(solved, -drop, -alone))


def _inward_drop(wanted: Array, valve: dict[str, Array]) -> Array:
    """Pressure drop of inward flow with the check valve open, without derivatives."""
    low = valve["cracking_pressure"]
    high = orifice_pressure_drop(
        area=valve["check_area"],
        flow=wanted,
        density=valve["density"],
        dynamic_viscosity=valve["dynamic_viscosity"],
    )
    high = maximum(high, low + valve["opening_span"])
    drop = 0.5 * (low + high)
    for _ in range(_STEPS):
        missing = wanted + one_way_flow(pressure_difference=-drop, **valve)
        step = missing / one_way_conductance(pressure_difference=-drop, **valve)
        if namespace(drop).all(absolute(step) <= _TOLERANCE * drop):
            break
        low, high = where(missing > 0, drop, low), where(missing > 0, high, drop)
        inside = (drop + step > low) & (drop + step < high)
        drop = where(inside, drop + step, 0.5 * (low + high))
    return drop


def _opened(
    pressure_difference: Array, cracking_pressure: Array, opening_span: Array
) -> tuple[Array, Array]:
    """Open share of the check valve's area, and its derivative by the pressure difference."""
    share = clip((-pressure_difference - cracking_pressure) / opening_span, 0.0, 1.0)
    return share * share * (3 - 2 * share), -6 * share * (1 - share) / opening_span
