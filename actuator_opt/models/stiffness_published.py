"""Stiffness formulas exactly as the sources print them, to reproduce and compare.

The sources sum each kind (oil, barrel, hoses) over both chambers and put these *totals* in series.
With hoses this is wrong by up to 13 %; `stiffness` has the correct formulas.
"""

from __future__ import annotations

import math

from ..base.numeric import Array, geometry
from .barrel import bore_growth_as_published
from .lines import line_compliance


def series_of_totals_as_published(
    *, oil: Array, barrel: Array, rod: Array, lines: Array = math.inf, other: Array = math.inf
) -> Array:
    """Total stiffness as the sources write it: oil, barrel, lines and rod in series.

    1/k = 1/k_oil + 1/k_rod + 1/k_barrel + 1/k_lines + 1/k_other.

    Parameters
    ----------
    oil : result of `oil_stiffness_as_published` [N/m]
    barrel : sum of both chambers' barrel stiffness [N/m]
    rod : [N/m]
    lines : sum of both chambers' line stiffness [N/m] (infinite: rigid)
    other : load cell, mounting, seals [N/m] (infinite: rigid)

    Returns
    -------
    stiffness as published [N/m]

    Notes
    -----
    Valid: to reproduce the sources only; use `stiffness.hydraulic_stiffness`.

    References
    ----------
    [AaltoThesis] eq. 3, 37, 38; [ElAsswad2018] eq. 7

    Examples
    --------
    >>> print(f"{series_of_totals_as_published(oil=2480e3, barrel=1e99, rod=13430e3):.4g}")
    2.093e+06
    """
    return 1 / (1 / oil + 1 / barrel + 1 / rod + 1 / lines + 1 / other)


@geometry
def oil_stiffness_as_published(
    *,
    bulk_modulus_a: Array,
    bulk_modulus_b: Array,
    area_a: Array,
    area_b: Array,
    volume_a: Array,
    volume_b: Array,
) -> Array:
    """Stiffness of the oil alone, k_o = K_A A_A^2/V_A + K_B A_B^2/V_B.

    Parameters
    ----------
    bulk_modulus_a, bulk_modulus_b : [Pa] ([ElAsswad2018] uses one value for both)
    area_a, area_b : [m^2]
    volume_a, volume_b : chamber volumes with line volumes [m^3]

    Returns
    -------
    stiffness [N/m]

    Notes
    -----
    Valid: rigid walls.

    References
    ----------
    [ElAsswad2018] eq. 9, [AaltoThesis] eq. 6

    Examples
    --------
    >>> round(oil_stiffness_as_published(bulk_modulus_a=8e8, bulk_modulus_b=8e8, area_a=5e-4,
    ...                                  area_b=5e-4, volume_a=5e-5, volume_b=5e-5))
    8000000
    """
    side_a = bulk_modulus_a * area_a * area_a / volume_a
    return side_a + bulk_modulus_b * area_b * area_b / volume_b


@geometry
def barrel_stiffness_as_published(
    *,
    bore: Array,
    outer_diameter: Array,
    area: Array,
    chamber_length: Array,
    youngs_modulus: Array,
    poissons_ratio: Array,
) -> Array:
    """Barrel expansion stiffness of one chamber, k_c = E A/(2 l (lambda + nu)).

    lambda = (D_o^2 + D^2)/(D_o^2 - D^2), with the bore D and the outer diameter D_o.
    With A = A_A (eq. 22) it equals A^2/(dV/dp). With A = A_B (eq. 23) it is too stiff by the factor
    A_A/A_B, since the wall swells over the full bore in both chambers.

    Parameters
    ----------
    bore, outer_diameter : [m]
    area : the chamber's effective piston area [m^2]
    chamber_length : [m]
    youngs_modulus, poissons_ratio : [Pa], [-]

    Returns
    -------
    stiffness [N/m]

    Notes
    -----
    Valid: eq. 22 isotropic, open ends; eq. 23 to reproduce the source only.

    References
    ----------
    [AaltoThesis] eq. 22, 23, 24

    Examples
    --------
    >>> k = barrel_stiffness_as_published(bore=0.04, outer_diameter=0.05, area=1.2566e-3,
    ...     chamber_length=0.11, youngs_modulus=210e9, poissons_ratio=0.3)
    >>> print(f"{k / 1e6:.1f} MN/m")
    247.0 MN/m
    """
    compliance = line_compliance(
        inner_diameter=bore,
        outer_diameter=outer_diameter,
        length=chamber_length,
        youngs_modulus=youngs_modulus,
        poissons_ratio=poissons_ratio,
    )
    return area * (0.25 * math.pi) * bore * bore / compliance


@geometry
def line_stiffness_as_published(
    *,
    area: Array,
    inner_diameter: Array,
    outer_diameter: Array,
    length: Array,
    youngs_modulus: Array,
    poissons_ratio: Array,
) -> Array:
    """Expansion stiffness of one chamber's pipe or hose, k = 2 E A^2/(pi D^2 l (lambda + nu)).

    lambda = (D_o^2 + D^2)/(D_o^2 - D^2), with the inner diameter D and the outer diameter D_o.

    Parameters
    ----------
    area : the chamber's effective piston area [m^2]
    inner_diameter, outer_diameter, length : of the line [m]
    youngs_modulus, poissons_ratio : [Pa], [-]

    Returns
    -------
    stiffness [N/m]

    Notes
    -----
    Valid: isotropic open-ended line, for which it equals A^2/(dV/dp) exactly.

    References
    ----------
    [AaltoThesis] eq. 25, 26

    Examples
    --------
    >>> k = line_stiffness_as_published(area=1.2566e-3, inner_diameter=9.5e-3, length=0.6,
    ...     outer_diameter=12e-3, youngs_modulus=17.8e9, poissons_ratio=0.3)
    >>> print(f"{k / 1e6:.1f} MN/m")
    70.9 MN/m
    """
    compliance = line_compliance(
        inner_diameter=inner_diameter,
        outer_diameter=outer_diameter,
        length=length,
        youngs_modulus=youngs_modulus,
        poissons_ratio=poissons_ratio,
    )
    return area * area / compliance


@geometry
def cylinder_expansion_as_published(*, pressure: Array, area: Array, stroke: Array) -> Array:
    """Evaluate the source's "cylinder expansion stiffness" dp A/L_p, which is no true stiffness.

    L_p is the stroke. The result has the right unit, but it grows with pressure, whereas the true
    stiffness A^2/(dV/dp) does not.

    Parameters
    ----------
    pressure : pressure difference [Pa]
    area : [m^2]
    stroke : [m]

    Returns
    -------
    stiffness as published [N/m]

    Notes
    -----
    Valid: to reproduce the source only.

    Eq. 11, the area of the expanded bore, lacks its /4 in the extracted text: pass pi (D + 2
    u)^2/4.

    References
    ----------
    [ElAsswad2018] eq. 10 and 11

    Examples
    --------
    >>> k = cylinder_expansion_as_published(pressure=1e6, area=4.9087e-4, stroke=0.11)
    >>> print(f"{k / 1e3:.2f} N/mm")
    4.46 N/mm
    """
    return pressure * area / stroke


@geometry
def equivalent_stiffness_as_published(
    *,
    pressure: Array,
    bore: Array,
    outer_diameter: Array,
    youngs_modulus: Array,
    poissons_ratio: Array,
    stroke: Array,
    oil: Array,
    rod: Array,
) -> tuple[Array, Array]:
    """Equivalent stiffness and radial expansion of the bore over time, as in figure 10.

    k = dp A/L_p, with the stroke L_p and the area A of the bore expanded by eq. 12, is put in
    series with oil and rod.
    The result is zero at zero pressure, since `cylinder_expansion_as_published` is no stiffness.
    The correct stiffness, `stiffness.hydraulic_stiffness` with `barrel.chamber_compliance`, treats
    each chamber separately and does not depend on the pressure.

    Parameters
    ----------
    pressure : pressure difference at each time [Pa]
    bore, outer_diameter : of the barrel [m]
    youngs_modulus, poissons_ratio : of the barrel [Pa], [-]; the source uses a bending modulus
    stroke : [m]
    oil, rod : stiffness of oil and rod [N/m]

    Returns
    -------
    equivalent stiffness [N/m], radial expansion of the bore [m], at each time

    Notes
    -----
    Valid: to reproduce the source only.

    References
    ----------
    [ElAsswad2018] eq. 7, 10, 11, 12 and figure 10

    Examples
    --------
    >>> import numpy as np
    >>> record = 5e6 * np.sin(np.linspace(0.0, math.pi, 5)) ** 2  # or the columns of a measurement
    >>> k, growth = equivalent_stiffness_as_published(pressure=record, bore=0.025, stroke=0.11,
    ...     outer_diameter=0.03, youngs_modulus=3.48e9, poissons_ratio=0.3, oil=2480e3, rod=13430e3)
    >>> print(np.round(k / 1e3, 2), "N/mm", np.round(growth * 1e6, 1), "um")
    [ 0.   11.21 22.52 11.21  0.  ] N/mm [  0.  63. 126.  63.   0.] um
    """
    growth = bore_growth_as_published(
        pressure=pressure,
        inner_radius=bore / 2,
        outer_radius=outer_diameter / 2,
        youngs_modulus=youngs_modulus,
        poissons_ratio=poissons_ratio,
    )
    grown = bore + 2 * growth
    barrel = cylinder_expansion_as_published(
        pressure=pressure, area=0.25 * math.pi * grown * grown, stroke=stroke
    )
    return barrel / (1 + barrel * (1 / oil + 1 / rod)), growth
