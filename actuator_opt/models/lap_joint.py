"""Shear in the adhesive of a bonded overlap: from axial force, and from differential expansion."""

from __future__ import annotations

from math import pi

from ..base.numeric import Array, geometry, maximum, minimum, namespace, positive, sqrt


def _edge_ratio(*, loaded: Array, free: Array, reach: Array) -> Array:
    """Ratio of edge shear to mean shear, as in `bond_edge_shear`.

    `loaded` is K_l, `free` is K_f, and `reach` is G L^2/t_a.
    """
    half = sqrt(positive(reach * (1 / loaded + 1 / free))) / 2
    wave = namespace(half).tanh(half)
    return half * ((1 / wave - wave) + 2 * free / (free + loaded) * wave)  # no term below zero


@geometry
def least_bond_peak_ratio(
    *,
    shear_modulus: Array,
    bond_thickness: Array,
    length: Array,
    membrane_stiffness: Array,
) -> Array:
    """Lower bound on the ratio of peak to mean shear in a bonded overlap, from one wall's data.

    (w/2) coth(w/2), w^2 = 2 G L^2/(t_a K). This is the exact ratio for two walls of equal
    stiffness K; if the second wall is stiffer or softer, the ratio is higher.

    Parameters
    ----------
    shear_modulus : G of the adhesive [Pa]
    bond_thickness : t_a of the adhesive [m]
    length : L, overlap [m]
    membrane_stiffness : K, axial E t of either wall [N/m]

    Returns
    -------
    lower bound on the ratio of peak to mean [-]

    Notes
    -----
    Valid: as `bond_edge_shear`; exact for equal walls.

    At the edge where wall 2 ends and wall 1 carries the whole force,
    tau ~ (coth(w)/K_1 + csch(w)/K_2)/w with w^2 = (G L^2/t_a)(1/K_1 + 1/K_2). This falls as 1/K_2
    rises, because 2 sinh w <= w + sinh w cosh w and sinh w <= w cosh w.

    References
    ----------
    [derived] from [Volkersen1938]

    Examples
    --------
    >>> r = least_bond_peak_ratio(shear_modulus=1e9, bond_thickness=0.2e-3, length=20e-3,
    ...                           membrane_stiffness=50e6)
    >>> print(f"{r:.4f}")
    4.4733
    """
    half = length * sqrt(shear_modulus / (2 * bond_thickness * membrane_stiffness))
    return half / namespace(half).tanh(half)


@geometry
def bond_edge_shear(
    *,
    force: Array,
    diameter: Array,
    length: Array,
    shear_modulus: Array,
    bond_thickness: Array,
    membrane_stiffness_loaded: Array,
    membrane_stiffness_free: Array,
) -> Array:
    """Shear stress at one edge of a bonded cap.

    Call it for each edge: the stress at one edge is a smooth function, but the larger of both has a
    kink where they are equal.

    tau = F/(pi D L) (w/2) [coth(w/2) + ((K_f - K_l)/(K_f + K_l)) tanh(w/2)],
    w^2 = (G L^2/t_a)(1/K_l + 1/K_f); K_l belongs to the wall that carries the whole force at this
    edge, K_f to the wall that ends here.

    Parameters
    ----------
    force : axial force through the bond [N]
    diameter : diameter of the bond surface [m]
    length : overlap [m]
    shear_modulus, bond_thickness : G and thickness of the adhesive [Pa], [m]
    membrane_stiffness_loaded, membrane_stiffness_free : K_l and K_f, axial E t of the walls [N/m]

    Returns
    -------
    shear stress at the edge [Pa]

    Notes
    -----
    Valid: linear adhesive, walls thin compared with the radius, no peel.

    A ductile adhesive levels the peak, so the result is conservative. Length beyond w of about 5
    does not lower the peak. For a plug or a thick sleeve take K = E A/(pi D), with D of the bond.

    References
    ----------
    [Volkersen1938] shear lag of a lap joint

    Examples
    --------
    >>> common = dict(force=10e3, diameter=30e-3, length=20e-3, shear_modulus=1e9,
    ...               bond_thickness=0.2e-3)
    >>> tau = bond_edge_shear(**common, membrane_stiffness_loaded=50e6,
    ...                       membrane_stiffness_free=100e6)
    >>> print(f"{tau / 1e6:.2f} MPa")
    27.41 MPa
    """
    ratio = _edge_ratio(
        loaded=membrane_stiffness_loaded,
        free=membrane_stiffness_free,
        reach=shear_modulus / bond_thickness * length * length,
    )
    return force / (pi * diameter * length) * ratio


@geometry
def bond_thermal_shear(
    *,
    strain_difference: Array,
    length: Array,
    shear_modulus: Array,
    bond_thickness: Array,
    membrane_stiffness_1: Array,
    membrane_stiffness_2: Array,
) -> Array:
    """Shear stress at an edge of a bonded overlap whose walls change length unequally.

    tau = (G L/t_a) (e_l - e_f) tanh(w/2)/w, w as in `bond_edge_shear`; the other edge has -tau.
    It adds to the shear of a tensile force from `bond_edge_shear`; l is the wall that carries that
    force at this edge, f the wall that ends here.

    Parameters
    ----------
    strain_difference : e_l - e_f, free axial strains alpha dT (and swelling) of both walls [-]
    length : L, overlap [m]
    shear_modulus, bond_thickness : G and thickness of the adhesive [Pa], [m]
    membrane_stiffness_1, membrane_stiffness_2 : axial E t of both walls, either order [N/m]

    Returns
    -------
    shear stress at the edge [Pa]

    Notes
    -----
    Valid: as `bond_edge_shear`; stress-free at the reference temperature (cure).

    `layered_tube` gives the radial stress from unequal hoop expansion.

    References
    ----------
    [derived] Volkersen's tau'' = (w/L)^2 tau with tau' = (G/t_a)(e_f - e_l) at both edges

    Examples
    --------
    >>> tau = bond_thermal_shear(strain_difference=22e-6 * 100, length=20e-3, shear_modulus=1e9,
    ...                          bond_thickness=0.2e-3, membrane_stiffness_1=100e6,
    ...                          membrane_stiffness_2=50e6)
    >>> print(f"{tau / 1e6:.2f} MPa")
    28.38 MPa
    """
    lag = shear_modulus / bond_thickness
    flex = 1 / membrane_stiffness_1 + 1 / membrane_stiffness_2
    decay = sqrt(positive(lag * flex))
    return lag * strain_difference / decay * namespace(decay).tanh(decay * length / 2)


@geometry
def ultimate_line_force(
    *,
    strain_difference: Array,
    length: Array,
    strength: Array,
    shear_modulus: Array,
    plastic_shear_strain: Array,
    bond_thickness: Array,
    membrane_stiffness_loaded: Array,
    membrane_stiffness_free: Array,
) -> Array:
    """Force per circumference at which one edge of a ductile bond breaks, with unequal expansion.

    N = K_l (sqrt(2 t_a U (1/K_l + 1/K_f)) - (e_l - e_f)), at most tau_p L. U = tau_p (gamma_e/2 +
    gamma_p), gamma_e = tau_p/G, is the area under the adhesive's shear curve. In a ductile
    adhesive, the stresses of force and temperature do not add; their strains do.

    Parameters
    ----------
    strain_difference : e_l - e_f, free axial strains of both walls [-]
    length : L, overlap [m]
    strength : tau_p, shear strength of the adhesive [Pa]
    shear_modulus : G of the adhesive [Pa]
    plastic_shear_strain : gamma_p, shear strain at failure less the elastic one [-]
    bond_thickness : t_a of the adhesive [m]
    membrane_stiffness_loaded, membrane_stiffness_free : K_l of the wall that carries the whole
        force at this edge, and K_f of the wall that ends here [N/m]

    Returns
    -------
    force per circumference [N/m]; 0 where the expansion alone breaks the edge

    Notes
    -----
    Valid: long overlap, elastic walls, an adhesive that is elastic and then plastic at tau_p.

    References
    ----------
    [Rice1968] J integral; [HartSmith1973] elastic-plastic adhesive; [derived] J of the shear lag

    Examples
    --------
    >>> line_force = ultimate_line_force(strain_difference=6e-4, length=16e-3, strength=28e6,
    ...     shear_modulus=1.2e9, plastic_shear_strain=0.1, bond_thickness=0.15e-3,
    ...     membrane_stiffness_loaded=120e6, membrane_stiffness_free=140e6)
    >>> print(f"{line_force / 1e3:.3f} N/mm")
    385.209 N/mm
    """
    energy = strength * (strength / shear_modulus / 2 + plastic_shear_strain)
    flex = 1 / membrane_stiffness_loaded + 1 / membrane_stiffness_free
    reach = sqrt(2 * bond_thickness * energy * flex) - strain_difference
    return minimum(maximum(membrane_stiffness_loaded * reach, 0.0), strength * length)


@geometry
def edge_peel(
    *,
    shear: Array,
    adhesive_modulus: Array,
    bond_thickness: Array,
    skirt_modulus: Array,
    skirt_poissons_ratio: Array,
    skirt_thickness: Array,
) -> Array:
    """Peel stress at the free edge of an outer skirt, from the shear stress there.

    sigma = tau (3 E_a (1 - nu^2) t_s/(E_s t_a))^(1/4): the skirt is a beam on the adhesive, bent by
    the shear on its inner face.

    Parameters
    ----------
    shear : tau at the edge [Pa]
    adhesive_modulus : E_a, Young's modulus of the adhesive [Pa]
    bond_thickness : t_a of the adhesive [m]
    skirt_modulus, skirt_poissons_ratio : E_s and nu of the skirt [Pa], [-]
    skirt_thickness : t_s [m]

    Returns
    -------
    stress across the bond [Pa]

    Notes
    -----
    Valid: long overlap, a wall that is thicker than the skirt, shear constant near the edge.

    Shear that falls off from the edge gives less. The skirt's hoop stiffness, which is left out,
    lowers the result by 2 to 4 %.

    References
    ----------
    [HartSmith1973]; [derived] beam on an elastic foundation

    Examples
    --------
    >>> sigma = edge_peel(shear=28e6, adhesive_modulus=3e9, bond_thickness=0.15e-3,
    ...                   skirt_modulus=71.7e9, skirt_poissons_ratio=0.33, skirt_thickness=2e-3)
    >>> print(f"{sigma / 1e6:.4f} MPa")
    30.9425 MPa
    """
    plate = skirt_modulus / (1 - skirt_poissons_ratio * skirt_poissons_ratio)
    ratio = 3 * adhesive_modulus * skirt_thickness / (plate * bond_thickness)
    return shear * sqrt(sqrt(ratio))
