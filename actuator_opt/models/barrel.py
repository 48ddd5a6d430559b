"""Isotropic barrel: bore growth, wall stress, burst, chamber compliance.

The models are Lamé's thick cylinder under internal gauge pressure with any axial force, and the
bore growth as [ElAsswad2018] published it. The axial load path and the growth beside a pressure
step are in `barrel_ends`.
"""

from __future__ import annotations

from math import pi

import numpy as np

from ..base.numeric import Array, array_of, geometry, namespace, positive, real, sqrt


@geometry
def bore_growth(
    *,
    pressure: Array,
    inner_radius: Array,
    outer_radius: Array,
    youngs_modulus: Array,
    poissons_ratio: Array,
    axial_force: Array = 0.0,
) -> Array:
    """Radial growth of the bore of a thick cylinder.

    u = (r_i/E) [p (lambda + nu) - nu N/(pi (r_o^2 - r_i^2))], lambda = (k^2 + 1)/(k^2 - 1),
    k = r_o/r_i. N = 0 is an open cylinder, N = p pi r_i^2 a closed cylinder.

    Parameters
    ----------
    pressure : internal gauge pressure [Pa]
    inner_radius, outer_radius : radii of the wall [m]
    youngs_modulus : Young's modulus [Pa]
    poissons_ratio : Poisson's ratio [-]
    axial_force : tensile force in the wall [N]

    Returns
    -------
    radial growth of the bore [m]; NaN where the wall has no thickness

    Notes
    -----
    Valid: linear elastic, far from the ends and from a pressure step.

    References
    ----------
    [ElAsswad2018] eq. 12 with the inner radius; [AaltoThesis] eq. 22; general N [derived] from
    u(r) = (r/E) (sigma_hoop - nu (sigma_radial + sigma_axial)).

    Examples
    --------
    >>> u = bore_growth(pressure=28e6, inner_radius=16e-3, outer_radius=20e-3,
    ...                 youngs_modulus=71.7e9, poissons_ratio=0.33)
    >>> print(f"{u * 1e6:.4f} um")
    30.5262 um
    """
    inner, outer = inner_radius * inner_radius, outer_radius * outer_radius
    annulus = positive(outer - inner)
    wall_ratio = (outer + inner) / annulus
    axial_stress = axial_force / (pi * annulus)
    load = pressure * (wall_ratio + poissons_ratio) - poissons_ratio * axial_stress
    return inner_radius / youngs_modulus * load


@geometry
def bore_growth_as_published(
    *,
    pressure: Array,
    inner_radius: Array,
    outer_radius: Array,
    youngs_modulus: Array,
    poissons_ratio: Array,
) -> Array:
    """Radial growth of the bore as the source prints it, with the outer radius and for open ends.

    u = (r_o p/E) (lambda + nu), lambda = (k^2 + 1)/(k^2 - 1), k = r_o/r_i. The result is r_o/r_i
    times too large, because theory requires the inner radius.

    Parameters
    ----------
    pressure : pressure difference across the wall [Pa]
    inner_radius, outer_radius : radii of the wall [m]
    youngs_modulus : Young's modulus [Pa]; the source inserts a bending modulus
    poissons_ratio : Poisson's ratio [-]

    Returns
    -------
    radial growth as published [m]; NaN where the wall has no thickness

    Notes
    -----
    Valid: to reproduce the source only.

    References
    ----------
    [ElAsswad2018] eq. 12

    Examples
    --------
    >>> u = bore_growth_as_published(pressure=28e6, inner_radius=16e-3, outer_radius=20e-3,
    ...                              youngs_modulus=71.7e9, poissons_ratio=0.33)
    >>> print(f"{u * 1e6:.4f} um")
    38.1578 um
    """
    inner, outer = inner_radius * inner_radius, outer_radius * outer_radius
    wall_ratio = (outer + inner) / positive(outer - inner)
    return outer_radius * pressure / youngs_modulus * (wall_ratio + poissons_ratio)


@geometry
def bore_stresses(
    *, pressure: Array, inner_radius: Array, outer_radius: Array, axial_force: Array = 0.0
) -> tuple[Array, Array, Array]:
    """Principal stresses at the bore of a thick cylinder.

    sigma_hoop = p lambda, sigma_radial = -p, sigma_axial = N/(pi (r_o^2 - r_i^2)),
    lambda = (k^2 + 1)/(k^2 - 1), k = r_o/r_i.

    Parameters
    ----------
    pressure : internal gauge pressure [Pa]
    inner_radius, outer_radius : radii of the wall [m]
    axial_force : tensile force in the wall [N]

    Returns
    -------
    hoop, radial and axial stress [Pa], tension positive; NaN where the wall has no thickness

    Notes
    -----
    Valid: linear elastic, far from the ends. The bore is the most stressed fibre.

    References
    ----------
    [Timoshenko1970] thick-walled cylinder (Lamé)

    Examples
    --------
    >>> hoop, radial, axial = bore_stresses(pressure=28e6, inner_radius=16e-3, outer_radius=20e-3)
    >>> print(f"{hoop / 1e6:.3f} {radial / 1e6:.1f} {axial:.1f}")
    127.556 -28.0 0.0
    """
    inner, outer = inner_radius * inner_radius, outer_radius * outer_radius
    annulus = positive(outer - inner)
    return pressure * (outer + inner) / annulus, -pressure, axial_force / (pi * annulus)


def von_mises(*, hoop: Array, radial: Array, axial: Array) -> Array:
    """Von Mises stress of three principal stresses.

    sigma = sqrt(((s_h - s_r)^2 + (s_r - s_a)^2 + (s_a - s_h)^2)/2).

    Parameters
    ----------
    hoop, radial, axial : principal stresses [Pa]

    Returns
    -------
    von Mises stress [Pa]

    Notes
    -----
    Valid: any stress state.

    References
    ----------
    [Timoshenko1970] distortion energy

    Examples
    --------
    >>> print(f"{von_mises(hoop=100.0, radial=0.0, axial=50.0):.4f}")
    86.6025
    """
    first, second, third = hoop - radial, radial - axial, axial - hoop
    squares = first * first + second * second + third * third
    return namespace(squares).sqrt(squares / 2)


@geometry
def burst_pressure_thick(
    *,
    inner_radius: Array,
    outer_radius: Array,
    yield_strength: Array,
    ultimate_strength: Array,
    axial_force_ratio: Array = 1.0,
) -> Array:
    """Burst pressure of a ductile metal tube.

    p = c sigma_y ln(k) (2 - sigma_y/sigma_u), c = 1/sqrt(1 - n/2 + n^2/4), n = N/(p pi r_i^2):
    c = 2/sqrt(3) for a closed cylinder (Faupel), 1 for an open cylinder.

    Parameters
    ----------
    inner_radius, outer_radius : radii of the wall [m]
    yield_strength, ultimate_strength : tensile strengths [Pa]
    axial_force_ratio : n, the wall's axial force / that of a closed cylinder [-], 0 to 1

    Returns
    -------
    burst pressure [Pa]; NaN where the wall has no thickness

    Notes
    -----
    Valid: ductile metals, k up to about 4.

    Faupel's tests scatter within about 15 %. The factor c is exact at n = 1 for every k and at
    n = 0 for a thin wall.

    References
    ----------
    [Faupel1956] closed ends; c [derived] from von Mises in plane stress with axial/hoop = n/2.

    Examples
    --------
    >>> p = burst_pressure_thick(inner_radius=16e-3, outer_radius=20e-3, yield_strength=355e6,
    ...                          ultimate_strength=490e6)
    >>> print(f"{p / 1e6:.2f} MPa")
    116.67 MPa
    """
    xp = namespace(inner_radius, outer_radius, yield_strength, axial_force_ratio)
    half = axial_force_ratio / 2
    wall = xp.log(positive(outer_radius / inner_radius))
    flow = yield_strength * (2 - yield_strength / ultimate_strength)
    return positive(wall) * flow / sqrt(1 - half + half * half)


@geometry
def chamber_compliance(*, inner_radius: Array, growth_per_pressure: Array, length: Array) -> Array:
    """Volume that a chamber gains per unit pressure because its wall swells.

    dV/dp = 2 pi r_i L (u/p), taken over the full bore perimeter in both chambers.

    Parameters
    ----------
    inner_radius : bore radius [m]
    growth_per_pressure : radial bore growth per pressure [m/Pa]
    length : wetted length, dead length included [m]

    Returns
    -------
    compliance [m^3/Pa]

    Notes
    -----
    Valid: long against the decay length of the growth; end restraint neglected (conservative).

    References
    ----------
    [derived] first-order volume of a swelling tube

    Examples
    --------
    >>> c = chamber_compliance(inner_radius=16e-3, growth_per_pressure=30.5262e-6 / 28e6,
    ...                        length=0.18)
    >>> print(f"{c * 1e15:.4f} mm^3/MPa")
    19.7282 mm^3/MPa
    """
    return 2 * pi * inner_radius * growth_per_pressure * length


@geometry
def barrel_stiffness(*, area: Array, compliance: Array) -> Array:
    """Axial stiffness of one chamber if only its wall gave way.

    k = A^2/(dV/dp), with the effective area of the chamber.

    Parameters
    ----------
    area : effective piston area of the chamber [m^2]
    compliance : dV/dp of the wall [m^3/Pa]

    Returns
    -------
    stiffness [N/m]

    Notes
    -----
    Valid: small pressure changes.

    References
    ----------
    [AaltoThesis] eq. 22, and the corrected eq. 23 (A_B^2 over the full-bore dV/dp)

    Examples
    --------
    >>> print(f"{barrel_stiffness(area=8.042e-4, compliance=1.97282e-14) / 1e6:.2f} kN/mm")
    32.78 kN/mm
    """
    return area * area / compliance


def wall_ratio_for_strain(
    *, strain: Array, pressure: Array, youngs_modulus: Array, poissons_ratio: Array, closed: bool
) -> Array:
    """Wall ratio r_o/r_i at which the bore's hoop strain has a given value.

    X = strain E/p; open ends k = sqrt((X - nu + 1)/(X - nu - 1)), closed ends
    k = sqrt((X + 1 - 2 nu)/(X - 1 - nu)).

    Parameters
    ----------
    strain : allowed hoop strain of the bore, u/r_i [-]
    pressure : internal gauge pressure [Pa]
    youngs_modulus : Young's modulus [Pa]
    poissons_ratio : Poisson's ratio [-]
    closed : the wall carries the closed-end axial force p pi r_i^2

    Returns
    -------
    wall ratio k [-]

    Raises
    ------
    ValueError
        Where no wall, however thick, keeps the strain that small.

    Notes
    -----
    Valid: open X > 1 + nu, closed X > 1 + nu.

    References
    ----------
    [derived] inverse of `bore_growth`

    Examples
    --------
    >>> k = wall_ratio_for_strain(strain=0.0015, pressure=25e6, youngs_modulus=71.7e9,
    ...                           poissons_ratio=0.33, closed=False)
    >>> print(f"{k:.6f}")
    1.293425
    """
    ratio = strain * youngs_modulus / pressure
    excess = ratio - 1 - poissons_ratio
    if np.any(array_of(real(excess)) <= 0):
        message = (
            "no wall is thick enough for so small a bore strain: "
            "strain*youngs_modulus/pressure must exceed 1 + poissons_ratio"
        )
        raise ValueError(message)
    above = ratio + 1 - (2 * poissons_ratio if closed else poissons_ratio)
    return sqrt(above / excess)
