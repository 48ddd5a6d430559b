"""Radial clearance of a lapped spool from the leakage of its data sheet."""

from __future__ import annotations

from ..base.numeric import Array, geometry, positive, real, sqrt, where
from .lapped_edge import lapped_edge_flow
from .orifice import TURBULENT_COEFFICIENT

LEAST = 1e-8
"""Smallest clearance of the search [m]; through it, an edge passes practically nothing."""
ROUNDS = 50
"""Halvings of the logarithm of the bracket, to rounding."""
STEP = 5e-4
"""Relative step of the differences of fourth order in the last Newton step. Their error is of the
order of STEP^4."""


@geometry
def clearance_of_leakage(
    *,
    leakage: Array,
    leakage_drop: Array,
    overlap: Array,
    stroke: Array,
    density: Array,
    dynamic_viscosity: Array,
    rated_flow: Array,
    rated_drop: Array,
    rounding: Array = 0.0,
    flow_coefficient: Array = TURBULENT_COEFFICIENT,
) -> Array:
    """Clearance c at which a centred edge leaks as stated, q(-o, dp; c) = q_l.

    q is `lapped_edge.lapped_edge_flow`. The edge has the width with which it passes the rated flow
    at full stroke, w = q_r/q(s - o, dp_r; c, w = 1). The leakage rises with c. A search
    halves the logarithm of the bracket; a Newton step carries the derivative.

    Parameters
    ----------
    leakage, leakage_drop : q_l of one edge, > 0 [m^3/s], and its pressure drop [Pa]
    overlap : o >= 0 [m]
    stroke : s of the spool [m]
    density, dynamic_viscosity : of the oil of the data sheet [kg/m^3], [Pa s]
    rated_flow, rated_drop : q_r of one open edge [m^3/s] at dp_r [Pa]
    rounding : radius of the corners [m]
    flow_coefficient : C of the turbulent flow [-]

    Returns
    -------
    radial clearance [m], at most the stroke

    Notes
    -----
    Valid: leakage well below the flow of the open edge, spool centred in its bore.

    References
    ----------
    [Merritt1967] leakage of the centred valve by its clearance, recalled; [derived] its inverse

    Examples
    --------
    >>> c = clearance_of_leakage(leakage=0.13017 / 60000, leakage_drop=50e5, overlap=0.0,
    ...     stroke=0.5e-3, density=870.0, dynamic_viscosity=0.028, rated_flow=20 / 60000,
    ...     rated_drop=35e5)
    >>> print(f"{c * 1e6:.3f} um")
    4.000 um
    """
    oil = {
        "density": density,
        "dynamic_viscosity": dynamic_viscosity,
        "flow_coefficient": flow_coefficient,
        "rounding": rounding,
    }

    def excess(clearance: Array) -> Array:
        """Leakage at a clearance, minus that stated, over that stated."""
        gap = {"clearance": clearance, **oil}
        per_width = lapped_edge_flow(
            uncovered=stroke - overlap, pressure_drop=rated_drop, area_gradient=1.0, **gap
        )
        flow = lapped_edge_flow(
            uncovered=-overlap,
            pressure_drop=leakage_drop,
            area_gradient=rated_flow / positive(per_width),
            **gap,
        )
        return flow / leakage - 1.0

    low = LEAST + 0 * real(stroke + leakage + overlap)
    high = real(stroke) + 0 * low
    for _ in range(ROUNDS):
        middle = sqrt(low * high)
        leaks_less = real(excess(middle)) < 0
        low, high = where(leaks_less, middle, low), where(leaks_less, high, middle)
    found = sqrt(low * high)
    near, far = (real(excess(found * (1 + h)) - excess(found * (1 - h))) for h in (STEP, 2 * STEP))
    return found - excess(found) * 12 * STEP * found / (8 * near - far)
