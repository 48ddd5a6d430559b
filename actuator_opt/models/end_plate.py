"""Flat end plates under pressure: solid caps, and heads with a hole for the rod."""

from __future__ import annotations

from math import pi

from ..geometry import geometry
from ..numeric import Array, absolute, maximum, namespace, positive


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

    Simply supported at a, p on r < c: M = (p c^2/4) [(1 + nu) ln(a/c) + 1 - (1 - nu) c^2/(4 a^2)]
    at the centre, 6 M/t^2.

    Parameters
    ----------
    pressure : gauge pressure on the loaded circle [Pa]
    loaded_radius : c, radius of the bore [m]
    support_radius : a, radius the plate hangs at, >= c [m]
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
    """Radial bending stress at the hub of a plate held there: a cap on the neck of its clevis.

    Clamped at b, free at a, uniform p on the annulus and a ring force F at a:
    M = [F/(2 pi) + p a^2/2 - p b^2/2] L/C8 - p a^2 L17/C8, s = b/a,
    L = (1 + nu)/2 ln(a/b) + (1 - nu)/4 (1 - s^2), C8 = [1 + nu + (1 - nu) s^2]/2,
    L17 = {1 - (1 - nu)/4 (1 - s^4) - s^2 [1 + (1 + nu) ln(a/b)]}/4; 6 M/t^2.

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
def annular_plate_stress(
    *,
    pressure: Array,
    radius: Array,
    hole_radius: Array,
    thickness: Array,
    poissons_ratio: Array,
    clamped: bool = False,
    edge_force: Array = 0.0,
) -> Array:
    """Largest bending stress of a circular plate with a free hole, pressed on the annulus.

    The slope f = C_1 r/2 + C_2/r - (1/D)[p r^3/16 - (p b^2/2 - F/(2 pi))(r ln(r/a)/2 - r/4)]
    solves (1/r (r f)')' = -Q/D with Q = p (r^2 - b^2)/(2 r) + F/(2 pi r); C_1, C_2 from
    M_r(b) = 0 and M_r(a) = 0 or f(a) = 0. Tested: hoop bending at the hole and at the edge, and
    radial bending at a clamped edge, 6 M/t^2.

    Parameters
    ----------
    pressure : gauge pressure on the annulus [Pa]
    radius : a, radius of the support [m]
    hole_radius : b, radius of the hole [m]
    thickness : t [m]
    poissons_ratio : Poisson's ratio [-]
    clamped : the outer edge cannot turn; False is the safe choice
    edge_force : F, force spread round the hole, in the sense of the pressure [N]

    Returns
    -------
    bending stress [Pa]; NaN where the plate has no thickness or no annulus

    Notes
    -----
    Valid: t < a/2, deflection below t/2, 0 < b < a.

    A vanishing hole doubles the stress of the solid plate's centre.

    References
    ----------
    [derived] from the plate equation of [Timoshenko1959]; [Roark2002] table 11.2 cases 2a and 2e

    Examples
    --------
    >>> s = annular_plate_stress(pressure=10e6, radius=12.5e-3, hole_radius=6.25e-3,
    ...                          thickness=5e-3, poissons_ratio=0.3)
    >>> print(f"{s / 1e6:.2f} MPa")
    90.17 MPa
    """
    xp = namespace(radius, hole_radius, pressure)
    nu = poissons_ratio
    b = hole_radius / radius
    inner = positive(b * b)
    log = xp.log(positive(b))
    load = pressure * inner / 2 - edge_force / (2 * pi * radius * radius)

    def particular(r: Array, square: Array, log_r: Array) -> tuple[Array, Array]:
        """f/r and f' of the particular solution, times D/a^2 (r over a)."""
        turn = -pressure * square / 16 + load * (log_r / 2 - 0.25)
        return turn, -3 * pressure * square / 16 + load * (log_r / 2 + 0.25)

    turn_b, curve_b = particular(b, inner, log)
    turn_a, curve_a = particular(1.0, 1.0, 0.0)
    moment_b = curve_b + nu * turn_b
    if clamped:
        # f(a) = 0: c1/2 + c2 = -turn_a; M_r(b) = 0: (1 + nu) c1/2 - (1 - nu) c2/b^2 = -moment_b
        c2 = (moment_b - (1 + nu) * turn_a) / ((1 + nu) + (1 - nu) / inner)
        half = -turn_a - c2
    else:
        moment_a = curve_a + nu * turn_a
        c2 = (moment_b - moment_a) / ((1 - nu) * positive(1 / inner - 1))
        half = ((1 - nu) * c2 - moment_a) / (1 + nu)
    hoop_b = (1 + nu) * half + (1 - nu) * c2 / inner + turn_b + nu * curve_b
    hoop_a = (1 + nu) * half + (1 - nu) * c2 + turn_a + nu * curve_a
    radial_a = (1 + nu) * half - (1 - nu) * c2 + curve_a + nu * turn_a
    worst = maximum(maximum(absolute(hoop_b), absolute(hoop_a)), absolute(radial_a))
    slender = radius / positive(thickness)
    return 6 * worst * slender * slender
