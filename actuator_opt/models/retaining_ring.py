"""A plug in the bore, held by a ring in a groove: stresses of ring, groove, lip and wall.

The ring has a rectangular section and sits in a groove of the bore, outside the plug. The lip is
the rest of the bore between groove and end face. The static seal is on the plug, so that groove and
lip are free of pressure. Only the metal layer with the groove carries the force there.
"""

from __future__ import annotations

from math import pi

from ..base.numeric import Array, geometry, namespace, positive, sqrt
from .rod import section_area

SPLIT = 2.0
"""Largest moment in a split ring under a uniform couple, divided by that in a closed ring. Free at
its gap, the ring carries m r (1 - cos phi) at the angle phi from it [derived]."""


@geometry
def groove_area(*, bore_diameter: Array, groove_depth: Array) -> Array:
    """Area of the groove's flank that bears the ring, pi (d_2^2 - d_1^2)/4, d_2 = d_1 + 2 h.

    Parameters
    ----------
    bore_diameter : d_1 [m]
    groove_depth : h, radial [m]

    Returns
    -------
    area [m^2]

    Notes
    -----
    Valid: a sharp edge of the groove; a chamfer reduces the area.

    References
    ----------
    [derived] area of an annulus

    Examples
    --------
    >>> print(f"{groove_area(bore_diameter=21e-3, groove_depth=0.8e-3) * 1e6:.4f}")
    54.7894
    """
    outer = bore_diameter + 2 * groove_depth
    return section_area(outer_diameter=outer, inner_diameter=bore_diameter)


@geometry
def lip_shear(
    *, force: Array, bore_diameter: Array, groove_depth: Array, lip_length: Array
) -> Array:
    """Mean shear stress of the lip at the groove's diameter, F/(pi d_2 n), d_2 = d_1 + 2 h.

    Parameters
    ----------
    force : F [N]
    bore_diameter : d_1 [m]
    groove_depth : h [m]
    lip_length : axial length n between groove and end face [m]

    Returns
    -------
    stress [Pa]

    Notes
    -----
    Valid: a lip of one metal.

    References
    ----------
    [derived] force over the sheared cylinder

    Examples
    --------
    >>> tau = lip_shear(force=7273.57, bore_diameter=21e-3, groove_depth=0.8e-3, lip_length=3e-3)
    >>> print(f"{tau / 1e6:.4f}")
    34.1482
    """
    return force / (pi * (bore_diameter + 2 * groove_depth) * lip_length)


@geometry
def lip_bending(
    *, force: Array, bore_diameter: Array, groove_depth: Array, lip_length: Array
) -> Array:
    """Bending stress of the lip at the groove's diameter, 6 F a/(pi d_2 n^2).

    The lip is a cantilever from the groove's diameter d_2 = d_1 + 2 h inwards. The lever a is the
    distance from d_2 to the centroid of the flank's annulus, about h/2.

    Parameters
    ----------
    force : F [N]
    bore_diameter : d_1 [m]
    groove_depth : h [m]
    lip_length : axial length n between groove and end face [m]

    Returns
    -------
    stress [Pa]

    Notes
    -----
    Valid: uniform pressure on the flank.

    Hoop stress in the lip is ignored, so the result is an upper bound.

    References
    ----------
    [derived] cantilever under the flank's pressure, a = d_2/2 - (d_2^3 - d_1^3)/(3 (d_2^2 - d_1^2))

    Examples
    --------
    >>> sigma = lip_bending(force=7273.57, bore_diameter=21e-3, groove_depth=0.8e-3,
    ...                     lip_length=3e-3)
    >>> print(f"{sigma / 1e6:.4f}")
    26.9844
    """
    outer = bore_diameter + 2 * groove_depth
    square = bore_diameter * bore_diameter + bore_diameter * outer + outer * outer
    lever = outer / 2 - square / (3 * (bore_diameter + outer))
    return 6 * force * lever / (pi * outer * lip_length * lip_length)


@geometry
def ring_shear(*, force: Array, bore_diameter: Array, ring_thickness: Array) -> Array:
    """Mean shear stress of the ring at the bore's diameter, F/(pi d_1 s).

    Parameters
    ----------
    force : F [N]
    bore_diameter : d_1 [m]
    ring_thickness : axial thickness s [m]

    Returns
    -------
    stress [Pa]

    Notes
    -----
    Valid: a ring that fills its circumference; the gaps of a split ring are ignored.

    References
    ----------
    [derived] force over the sheared cylinder

    Examples
    --------
    >>> tau = ring_shear(force=7273.57, bore_diameter=21e-3, ring_thickness=1.5e-3)
    >>> print(f"{tau / 1e6:.4f}")
    73.5000
    """
    return force / (pi * bore_diameter * ring_thickness)


@geometry
def ring_dishing(
    *,
    force: Array,
    lever_length: Array,
    inner_radius: Array,
    outer_radius: Array,
    ring_thickness: Array,
) -> Array:
    """Hoop stress at the inner edge of the ring as the force dishes it.

    m = F g/(2 pi r_c), r_c = (b_i + b_o)/2; phi = 12 m r_c/(E s^3 ln(b_o/b_i));
    sigma = phi E s/(2 b_i) = 3 F g/(pi s^2 b_i ln(b_o/b_i)).

    Parameters
    ----------
    force : F [N]
    lever_length : radial distance g between the forces on both faces of the ring [m]
    inner_radius, outer_radius : b_i and b_o of the ring [m]
    ring_thickness : axial thickness s [m]

    Returns
    -------
    stress [Pa]

    Notes
    -----
    Valid: elastic, a section that keeps its shape, and a closed ring.

    In a split ring that nothing else supports, the moment opposite its gap is twice as large:
    `SPLIT`.

    References
    ----------
    [Timoshenko1959] article on the twisting of a ring of rectangular section

    Examples
    --------
    >>> sigma = ring_dishing(force=7273.57, lever_length=1.15e-3, inner_radius=9e-3,
    ...                      outer_radius=11.3e-3, ring_thickness=1.5e-3)
    >>> print(f"{sigma / 1e6:.1f}")
    1733.3
    """
    height = namespace(inner_radius).log(outer_radius / inner_radius)
    return 3 * force * lever_length / (pi * ring_thickness * ring_thickness * inner_radius * height)


@geometry
def springing(
    *,
    groove_depth: Array,
    inner_radius: Array,
    outer_radius: Array,
    youngs_modulus: Array,
) -> Array:
    """Hoop stress at the inner edge of a split ring that is closed to pass the bore.

    sigma = E h (b_o - b_i)/(2 (r_c - h) b_i), r_c = (b_i + b_o)/2: its radius falls by h.

    Parameters
    ----------
    groove_depth : h [m]
    inner_radius, outer_radius : b_i and b_o of the ring in its groove [m]
    youngs_modulus : E of the ring [Pa]

    Returns
    -------
    stress [Pa]

    Notes
    -----
    Valid: one ring with a gap, free of stress in its groove, bent to a circle.

    The neutral fibre is taken at r_c. It is nearer to the inner edge, which makes the stress an
    upper bound.

    References
    ----------
    [Timoshenko1959] bending of a curved bar

    Examples
    --------
    >>> sigma = springing(groove_depth=0.4e-3, inner_radius=8.7e-3, outer_radius=11.1e-3,
    ...                   youngs_modulus=206e9)
    >>> print(f"{sigma / 1e6:.1f}")
    1196.4
    """
    middle = (inner_radius + outer_radius) / 2
    width = outer_radius - inner_radius
    return youngs_modulus * groove_depth * width / (2 * (middle - groove_depth) * inner_radius)


@geometry
def plastic_dishing(
    *,
    force: Array,
    lever_length: Array,
    inner_radius: Array,
    outer_radius: Array,
    ring_thickness: Array,
) -> Array:
    """Yield stress at which the ring is fully plastic as the force dishes it.

    Half the thickness is in tension, half in compression: F g/(2 pi) = sigma (s^2/4) (b_o - b_i).

    Parameters
    ----------
    force : F [N]
    lever_length : radial distance g between the forces on both faces of the ring [m]
    inner_radius, outer_radius : b_i and b_o of the ring [m]
    ring_thickness : axial thickness s [m]

    Returns
    -------
    stress [Pa]

    Notes
    -----
    Valid: as `ring_dishing`, of a ductile metal.

    References
    ----------
    [derived] equilibrium of half a ring

    Examples
    --------
    >>> sigma = plastic_dishing(force=7273.57, lever_length=1.15e-3, inner_radius=9e-3,
    ...                         outer_radius=11.3e-3, ring_thickness=1.5e-3)
    >>> print(f"{sigma / 1e6:.1f}")
    1029.0
    """
    section = ring_thickness * ring_thickness * (outer_radius - inner_radius) / 4
    return force * lever_length / (2 * pi * section)


@geometry
def wall_stresses(
    *,
    force: Array,
    bore_diameter: Array,
    groove_depth: Array,
    lip_length: Array,
    thickness: Array,
    poissons_ratio: Array,
) -> tuple[Array, Array]:
    """Axial and bending stress of the metal under the groove.

    sigma = F/A of the metal under the groove, of thickness t_n = t - h. The force enters at the
    middle of the flank, h/2 + t_n/2 inside the middle of this metal. The moment per circumference
    F e/(2 pi r_n), e = t/2, bends the metal (K_n) and the lip (K_l):
    sigma_b = 6 M/t_n^2, M = F e/(2 pi r_n) K_n/(K_n + K_l). K_n = beta D is that of a long tube
    with thickness t_n, beta^4 = 3 (1 - nu^2)/(r_n t_n)^2, D = E t_n^3/(12 (1 - nu^2)). The lip
    turns as a ring and bends as a long tube of thickness t: 1/K_l = 1/K_r + 1/(beta_l D_l), with
    K_r = E n^3 ln(r_o/r_i)/(12 r_l).

    Parameters
    ----------
    force : F [N]
    bore_diameter : d_1 = 2 r_i [m]
    groove_depth : h [m]
    lip_length : axial length n between groove and end face [m]
    thickness : t, of the layer with the groove [m]
    poissons_ratio : nu, of the layer with the groove [-]

    Returns
    -------
    axial stress and bending stress at the root of the groove [Pa]

    Notes
    -----
    Valid: lip at least 0.7 t long; layers outside also resist bending, which is left out.

    Axisymmetric finite elements with r_i = 10.5 mm, t of 1.5 mm and 2.6 mm, and lips of 2 mm to
    8 mm give 0.8 to 1.07 of the sum of both stresses without layers outside, and less under a hoop
    winding. The peak at the root's radius is not included.

    References
    ----------
    [Timoshenko1959] end moment of a long tube, twisting of a ring; [derived] their equal rotation

    Examples
    --------
    >>> axial, bending = wall_stresses(force=7273.57, bore_diameter=21e-3, groove_depth=0.6e-3,
    ...                                lip_length=2e-3, thickness=2.6e-3, poissons_ratio=0.33)
    >>> print(f"{axial / 1e6:.3f} {bending / 1e6:.3f}")
    47.836 175.631
    """
    inner = bore_diameter / 2
    outer, remaining = inner + thickness, positive(thickness - groove_depth)
    radius = outer - remaining / 2
    factor = 1 - poissons_ratio * poissons_ratio
    middle = inner + thickness / 2

    def of_tube(radius: Array, wall: Array) -> Array:
        """Stiffness beta D of a long tube against an end moment, divided by E."""
        beta = sqrt(sqrt(3 * factor) / (radius * wall))
        return beta * wall * wall * wall / (12 * factor)

    cube = lip_length * lip_length * lip_length
    of_ring = cube * namespace(inner).log(outer / inner) / (12 * middle)
    of_wall, of_lip = of_tube(radius, remaining), of_tube(middle, thickness)
    of_lip = of_ring * of_lip / (of_ring + of_lip)
    moment = force * thickness / 2 / (2 * pi * radius) * of_wall / (of_wall + of_lip)
    area = section_area(outer_diameter=2 * outer, inner_diameter=2 * (inner + groove_depth))
    return force / area, 6 * moment / (remaining * remaining)


def collapse_factor(*, axial: Array, bending: Array, strength: Array) -> Array:
    """Factor on the loads at which a strip of rectangular section is fully plastic.

    (f n)^2 + f m = 1 with n = sigma/S and m = (2/3) sigma_b/S, so f = 2/(m + sqrt(m^2 + 4 n^2)).

    Parameters
    ----------
    axial, bending : elastic stresses sigma and sigma_b [Pa]
    strength : S [Pa]

    Returns
    -------
    factor [-]

    Notes
    -----
    Valid: a ductile metal. Help from the rest of the wall is ignored.

    References
    ----------
    [derived] plastic moment of a rectangle under axial force

    Examples
    --------
    >>> print(f"{collapse_factor(axial=100e6, bending=0.0, strength=500e6):.3f}")
    5.000
    >>> print(f"{collapse_factor(axial=0.0, bending=100e6, strength=500e6):.3f}")
    7.500
    """
    membrane, curved = axial / strength, bending * (2 / 3) / strength
    return 2 / (curved + sqrt(curved * curved + 4 * membrane * membrane))
