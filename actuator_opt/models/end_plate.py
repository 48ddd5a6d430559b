"""Flat end plates under pressure."""

from __future__ import annotations

from math import pi

from ..base.numeric import Array, geometry, maximum, minimum, namespace, positive, sqrt


@geometry
def end_plate_stress(
    *,
    pressure: Array,
    radius: Array,
    thickness: Array,
    poissons_ratio: Array,
    clamped: bool = False,
) -> Array:
    """Largest bending stress of a solid circular plate under uniform pressure.

    Simply supported: 3 (3 + nu) p a^2/(8 t^2) at the centre; clamped: 3 p a^2/(4 t^2) at the edge.

    Parameters
    ----------
    pressure : gauge pressure on the whole plate [Pa]
    radius : a, radius of the support [m]
    thickness : t [m]
    poissons_ratio : Poisson's ratio [-]
    clamped : the edge cannot turn; False is the safe choice

    Returns
    -------
    bending stress [Pa]; NaN where the plate has no thickness

    Notes
    -----
    Valid: t < a/2, deflection below t/2.

    References
    ----------
    [Timoshenko1959] circular plates; [Roark2002] table 11.2 case 10

    Examples
    --------
    >>> s = end_plate_stress(pressure=10e6, radius=12.5e-3, thickness=5e-3, poissons_ratio=0.3)
    >>> print(f"{s / 1e6:.2f} MPa")
    77.34 MPa
    """
    slender = radius / positive(thickness)
    factor = 0.75 if clamped else 3 * (3 + poissons_ratio) / 8
    return factor * pressure * slender * slender


@geometry
def hung_plate_stress(
    *,
    pressure: Array,
    loaded_radius: Array,
    support_radius: Array,
    thickness: Array,
    poissons_ratio: Array,
) -> Array:
    """Largest bending stress of a cap under pressure, hung on a skirt wider than the bore.

    For a plate simply supported at radius a with pressure on r < c, the stress at the centre
    is 6 M/t^2 with M = (p c^2/4) [(1 + nu) ln(a/c) + 1 - (1 - nu) c^2/(4 a^2)].

    Parameters
    ----------
    pressure : gauge pressure on the loaded circle [Pa]
    loaded_radius : c, radius of the bore [m]
    support_radius : a, radius at which the plate hangs, >= c [m]
    thickness : t [m]
    poissons_ratio : Poisson's ratio [-]

    Returns
    -------
    bending stress [Pa]; NaN where the plate has no thickness

    Notes
    -----
    Valid: t < a/2, deflection below t/2.

    References
    ----------
    [Timoshenko1959] circular plate loaded on a concentric circle

    Examples
    --------
    >>> s = hung_plate_stress(pressure=10e6, loaded_radius=12.5e-3, support_radius=12.5e-3,
    ...                       thickness=5e-3, poissons_ratio=0.3)
    >>> print(f"{s / 1e6:.2f} MPa")
    77.34 MPa
    """
    ratio = support_radius / loaded_radius
    log = namespace(ratio).log(ratio)
    spread = (1 + poissons_ratio) * log + 1 - (1 - poissons_ratio) / (4 * ratio * ratio)
    slender = loaded_radius / positive(thickness)
    return 1.5 * pressure * slender * slender * spread


@geometry
def hub_plate_stress(
    *,
    pressure: Array,
    edge_force: Array,
    hub_radius: Array,
    edge_radius: Array,
    thickness: Array,
    poissons_ratio: Array,
) -> Array:
    """Radial bending stress of a plate at the hub that holds it, such as the neck of a clevis.

    Plate clamped at radius b and free at a, with pressure p in between and a ring force F at a:
    M = [F/(2 pi) + p a^2/2 - p b^2/2] L/C8 - p a^2 L17/C8, s = b/a,
    L = (1 + nu)/2 ln(a/b) + (1 - nu)/4 (1 - s^2), C8 = [1 + nu + (1 - nu) s^2]/2,
    L17 = {1 - (1 - nu)/4 (1 - s^4) - s^2 [1 + (1 + nu) ln(a/b)]}/4. The stress is 6 M/t^2.

    Parameters
    ----------
    pressure : gauge pressure on the annulus [Pa]
    edge_force : total axial force on the outer edge, in the direction of the pressure [N]
    hub_radius : b, radius of the neck [m]
    edge_radius : a, outer radius [m]
    thickness : t [m]
    poissons_ratio : Poisson's ratio [-]

    Returns
    -------
    bending stress [Pa]; NaN where the plate has no thickness

    Notes
    -----
    Valid: b < a, t < a/2, deflection below t/2.

    References
    ----------
    [Roark2002] table 11.2 cases 1l and 2l

    Examples
    --------
    >>> s = hub_plate_stress(pressure=1e6, edge_force=0.0, hub_radius=10e-3, edge_radius=20e-3,
    ...                      thickness=4e-3, poissons_ratio=0.3)
    >>> print(f"{s / 1e6:.1f} MPa")
    26.0 MPa
    """
    share = hub_radius / edge_radius
    square = share * share
    log = -namespace(share).log(share)
    lever = (1 + poissons_ratio) / 2 * log + (1 - poissons_ratio) / 4 * (1 - square)
    flex = (1 + poissons_ratio + (1 - poissons_ratio) * square) / 2
    spread = (
        1
        - (1 - poissons_ratio) / 4 * (1 - square * square)
        - square * (1 + (1 + poissons_ratio) * log)
    ) / 4
    area = edge_radius * edge_radius
    moment = edge_force / (2 * pi) * lever
    moment = moment + pressure * area * ((1 - square) / 2 * lever - spread)
    return 6 * moment / flex / (positive(thickness) * thickness)


@geometry
def rim_tear_factor(
    *,
    force: Array,
    groove_radius: Array,
    skirt_radius: Array,
    lip_thickness: Array,
    strength: Array,
) -> Array:
    """Plastic load of a plug's rim between the groove of its seal and its skirt, over the load.

    The force crosses the lip of thickness b behind the groove. Per circumference of the groove's
    bottom r_g, q = F/(2 pi r_g) shears it, and bends it by q e, e = (r_s - r_g)/2 where the
    skirt's inner radius r_s is larger. lambda = 1/sqrt((sqrt 3 q/(sigma b))^2 +
    (4 q e/(sigma b^2))^2). A skirt that reaches inside the groove adds sigma pi (r_g^2 - r_s^2)/F.

    Parameters
    ----------
    force : F, force of the plug on its skirt [N]
    groove_radius : r_g [m]
    skirt_radius : r_s [m]
    lip_thickness : b [m]
    strength : sigma, flow or tensile strength [Pa]

    Returns
    -------
    factor [-]

    Notes
    -----
    Valid: ductile metals; plastic finite elements of two plugs give 1.00 to 1.10 of it.

    References
    ----------
    [derived] plastic shear and bending of a rectangular section, combined by a circle

    Examples
    --------
    >>> factor = rim_tear_factor(force=7824.0, groove_radius=9.476e-3, skirt_radius=10.1e-3,
    ...                          lip_thickness=1.135e-3, strength=572e6)
    >>> print(f"{factor:.3f}")
    2.408
    """
    line = force / (2 * pi * groove_radius)
    arm = maximum(skirt_radius - groove_radius, 0.0 * skirt_radius) / 2
    sheared = 3**0.5 * line / (strength * lip_thickness)
    bent = 4 * line * arm / (strength * lip_thickness * lip_thickness)
    inside = minimum(skirt_radius, groove_radius)
    direct = strength * pi * (groove_radius * groove_radius - inside * inside) / force
    return 1 / sqrt(sheared * sheared + bent * bent) + direct
