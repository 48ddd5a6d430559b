"""Fibres wound over a trap: a crest of metal, a flank that falls from it, and hoop plies behind.

The fibres of a band run along the barrel, over the crest, and down the flank into a valley. Hoop
plies in the valley hold them there. The axial force pushes the flank against the band. Friction on
the flank helps to hold the band; formulas without friction are on the safe side for hoop plies and
for the pressure on the flank.
"""

from __future__ import annotations

from math import pi

from ..base.numeric import Array, geometry, minimum, namespace, sqrt, tangent


def _tangent(angle: Array, friction_coefficient: Array) -> Array:
    """tan(psi + rho) with mu = tan(rho)."""
    slope = tangent(angle)
    return (slope + friction_coefficient) / (1 - friction_coefficient * slope)


@geometry
def flank_pressure(
    *,
    force: Array,
    crest_radius: Array,
    valley_radius: Array,
    angle: Array,
    friction_coefficient: Array = 0.0,
) -> Array:
    """Pressure between flank and band, p_n = p_0/(1 + mu cot psi), p_0 = F/(pi (r_2^2 - r_1^2)).

    Parameters
    ----------
    force : F, axial [N]
    crest_radius, valley_radius : r_2 and r_1 of the metal [m]
    angle : psi, of the flank to the axis [rad]
    friction_coefficient : mu [-]

    Returns
    -------
    pressure [Pa]

    Notes
    -----
    Valid: 0 < psi < 90 degrees, uniform pressure.

    References
    ----------
    [derived] axial equilibrium of the flank

    Examples
    --------
    >>> size = {"crest_radius": 16.5e-3, "valley_radius": 14e-3, "angle": 0.5235987755982988}
    >>> p = flank_pressure(force=7273.57, **size, friction_coefficient=0.1)
    >>> print(f"{p / 1e6:.4f}")
    25.8812
    """
    area = pi * (crest_radius - valley_radius) * (crest_radius + valley_radius)
    return force / area / (1 + friction_coefficient / tangent(angle))


@geometry
def hoop_force(*, force: Array, angle: Array, friction_coefficient: Array = 0.0) -> Array:
    """Tension of the hoop plies that hold the band on the flank, T = F/(2 pi tan(psi + rho)).

    Parameters
    ----------
    force : F, axial [N]
    angle : psi, of the flank to the axis [rad]
    friction_coefficient : mu = tan(rho) [-]

    Returns
    -------
    force [N]

    Notes
    -----
    Valid: psi + rho below 90 degrees.

    References
    ----------
    [derived] equilibrium of half a ring under F cot(psi + rho)/(2 pi r) per circumference

    Examples
    --------
    >>> t = hoop_force(force=7273.57, angle=0.5235987755982988, friction_coefficient=0.1)
    >>> print(f"{t:.2f}")
    1610.38
    """
    return force / (2 * pi * _tangent(angle, friction_coefficient))


@geometry
def radial_give(*, hoop_force: Array, radius: Array, section: Array, modulus: Array) -> Array:
    """Radial displacement of the hoop plies, u = T r_h/(A_h E_h).

    The axial displacement of the end is u/tan(psi).

    Parameters
    ----------
    hoop_force : T [N]
    radius : r_h, of the middle of the hoop plies [m]
    section : A_h [m^2]
    modulus : E_h, along the fibres [Pa]

    Returns
    -------
    displacement [m]

    Notes
    -----
    Valid: hoop plies much stiffer than the band beneath.

    References
    ----------
    [derived] thin ring

    Examples
    --------
    >>> u = radial_give(hoop_force=1610.38, radius=18e-3, section=20e-6, modulus=135e9)
    >>> print(f"{u * 1e6:.4f}")
    10.7359
    """
    return hoop_force * radius / (section * modulus)


@geometry
def compliance(
    *,
    radius: Array,
    section: Array,
    modulus: Array,
    angle: Array,
    friction_coefficient: Array = 0.0,
) -> Array:
    """Axial compliance of the end, C = r_h/(2 pi A_h E_h tan(psi) tan(psi + rho)).

    Parameters
    ----------
    radius : r_h, of the middle of the hoop plies [m]
    section : A_h, of the hoop plies [m^2]
    modulus : E_h, along the fibres [Pa]
    angle : psi, of the flank to the axis [rad]
    friction_coefficient : mu = tan(rho) [-]

    Returns
    -------
    compliance [m/N]

    Notes
    -----
    Valid: as `radial_give`; rigid metal and band.

    References
    ----------
    [derived] `hoop_force`, `radial_give`, and u/tan(psi)

    Examples
    --------
    >>> c = compliance(radius=18e-3, section=20e-6, modulus=135e9, angle=0.5235987755982988,
    ...                friction_coefficient=0.1)
    >>> print(f"{c * 1e9:.5f} um/kN")
    2.55652 um/kN
    """
    slopes = tangent(angle) * _tangent(angle, friction_coefficient)
    return radius / (2 * pi * section * modulus * slopes)


@geometry
def flank_shear(*, pressure: Array, angle: Array) -> Array:
    """Shear between band and hoop plies on the flank, which keeps them there: p sin(2 psi)/2.

    The band presses the hoop plies outwards by p cos(psi) per slant area. They take no axial force,
    so the normal stress q cos(psi) and the shear q sin(psi) on the slope, q = p cos(psi), balance.

    Parameters
    ----------
    pressure : p between flank and band [Pa]
    angle : psi, of the flank to the axis [rad]

    Returns
    -------
    stress [Pa]

    Notes
    -----
    Valid: no friction on the metal, and hoop plies on the flank only.

    References
    ----------
    [derived] equilibrium of the hoop plies

    Examples
    --------
    >>> print(f"{flank_shear(pressure=30.3639e6, angle=0.5235987755982988) / 1e6:.4f}")
    13.1480
    """
    return pressure * namespace(angle).sin(2 * angle) / 2


@geometry
def hoop_section(
    *, thickness: Array, width: Array, flank_height: Array, flank_length: Array
) -> Array:
    """Section of hoop plies with a flat top: floor of the valley, and wedge on the flank.

    A = t w + (t m - m^2/2) (l/h), m = min(t, h).

    Parameters
    ----------
    thickness : t, on the floor of the valley [m]
    width : w, on the floor of the valley [m]
    flank_height, flank_length : h and l, radial and axial length of the band's outside over the
        flank [m]

    Returns
    -------
    area [m^2]

    Notes
    -----
    Valid: plies that do not cover the crest.

    References
    ----------
    [derived] area of a rectangle and a trapezium

    Examples
    --------
    >>> a = hoop_section(thickness=3e-3, width=4e-3, flank_height=2e-3, flank_length=2e-3)
    >>> print(f"{a * 1e6:.1f}")
    16.0
    """
    on_flank = minimum(thickness, flank_height)
    return thickness * width + (thickness - on_flank / 2) * on_flank * flank_length / flank_height


@geometry
def hoop_reach(*, radius: Array, thickness: Array, modulus: Array, axial_modulus: Array) -> Array:
    """Axial distance from a radial load up to which hoop plies help, 1/beta = (4 D/k)^(1/4).

    k = E_h t/r^2, D = E_z t^3/12, so 1/beta = (E_z t^2 r^2/(3 E_h))^(1/4).

    Parameters
    ----------
    radius : r, of the hoop plies [m]
    thickness : t [m]
    modulus, axial_modulus : E_h along the fibres and E_z across them [Pa]

    Returns
    -------
    distance [m]

    Notes
    -----
    Valid: thin ring; shear and the band beneath are ignored.

    References
    ----------
    [Timoshenko1959] long cylindrical shell under a line load

    Examples
    --------
    >>> r = hoop_reach(radius=15e-3, thickness=2e-3, modulus=135e9, axial_modulus=8.5e9)
    >>> print(f"{r * 1e3:.3f}")
    2.085
    """
    reach2 = thickness * radius * sqrt(axial_modulus / (3 * modulus))
    return sqrt(reach2)


@geometry
def band_stress(*, line_force: Array, thickness: Array, angle: Array) -> Array:
    """Fibre stress of the band by netting, sigma_1 = N/(t cos^2 alpha).

    Parameters
    ----------
    line_force : axial force per circumference, N [N/m]
    thickness : t, of the band [m]
    angle : alpha, of the fibres to the meridian [rad]

    Returns
    -------
    stress [Pa]

    Notes
    -----
    Valid: balanced pairs whose matrix carries nothing; the hoop plies hold the hoop component.

    References
    ----------
    [derived] netting analysis

    Examples
    --------
    >>> n = 7273.57 / (2 * pi * 14e-3)
    >>> print(f"{band_stress(line_force=n, thickness=0.7e-3, angle=0.4363323129985824) / 1e6:.3f}")
    143.810
    """
    cosine = namespace(angle).cos(angle)
    return line_force / (thickness * cosine * cosine)


@geometry
def crest_factor(*, thickness: Array, crest_radius: Array) -> Array:
    """Largest fibre stress in a band over a crest divided by its mean, (t/R)/ln(1 + t/R).

    All fibres stretch by the same length, but those on the metal are shortest.

    Parameters
    ----------
    thickness : t, of the band [m]
    crest_radius : R, of the meridian [m]

    Returns
    -------
    ratio [-]

    Notes
    -----
    Valid: fibres that were cured over the crest, whose own curvature causes no stress.

    Matrix shear, which lets layers slide, is ignored.

    References
    ----------
    [derived] strain c/(R + z) with the same mean force

    Examples
    --------
    >>> print(f"{crest_factor(thickness=0.8e-3, crest_radius=3.2e-3):.4f}")
    1.1204
    """
    ratio = thickness / crest_radius
    return ratio / namespace(ratio).log(1 + ratio)


@geometry
def crest_pressure(*, line_force: Array, crest_radius: Array, angle: Array) -> Array:
    """Pressure that the band exerts on the crest, N/(R cos psi).

    Parameters
    ----------
    line_force : axial force per circumference, N [N/m]
    crest_radius : R, of the meridian [m]
    angle : psi, of the flank to the axis [rad]

    Returns
    -------
    pressure [Pa]

    Notes
    -----
    Valid: a band that is thin beside R, tension N/cos(psi) as on the flank.

    References
    ----------
    [derived] belt on a drum

    Examples
    --------
    >>> p = crest_pressure(line_force=100e3, crest_radius=3e-3, angle=0.7853981633974483)
    >>> print(f"{p / 1e6:.3f}")
    47.140
    """
    return line_force / (crest_radius * namespace(angle).cos(angle))


@geometry
def crest_shear(*, force: Array, valley_radius: Array, length: Array) -> Array:
    """Mean shear stress at the root of the crest, F/(2 pi r_1 L).

    Parameters
    ----------
    force : F, axial [N]
    valley_radius : r_1 [m]
    length : L, axial, of crest and flank [m]

    Returns
    -------
    stress [Pa]

    Notes
    -----
    Valid: the whole force enters the crest through its flank.

    References
    ----------
    [derived] force over the sheared cylinder

    Examples
    --------
    >>> print(f"{crest_shear(force=7273.57, valley_radius=14e-3, length=4e-3) / 1e6:.4f}")
    20.6719
    """
    return force / (2 * pi * valley_radius * length)


@geometry
def neck_stresses(
    *,
    force: Array,
    outer_radius: Array,
    wall_thickness: Array,
    crest_radius: Array,
    valley_radius: Array,
    flank_distance: Array,
    angle: Array,
) -> tuple[Array, Array]:
    """Axial and bending stress of the metal that carries the trap.

    sigma = F/A, A = pi (r_o^2 - (r_o - w)^2). The flank returns the force at the distance
    e = (r_1 + r_2)/2 - (r_o - w/2) outside the middle of this metal, and presses inwards with
    F cot(psi) at the axial distance z. Trap and neck take half of the moment
    F (e - z cot(psi)) each: sigma_b = 3 (e - z cot(psi)) sigma/w.

    Parameters
    ----------
    force : F, axial [N]
    outer_radius, wall_thickness : r_o and thickness w of the neck [m]
    crest_radius, valley_radius : r_2 and r_1 [m]
    flank_distance : z, from the neck to the middle of the flank [m]
    angle : psi, of the flank to the axis [rad]

    Returns
    -------
    pressure along the axis, and bending stress, positive if it adds at the outside [Pa]

    Notes
    -----
    Valid: a plate at least as thick as the neck; an upper bound of the bending.

    The hoop stiffness of the trap carries a part of the inward load. Axisymmetric finite elements
    of plugs with walls of 1.5 mm to 4 mm give 0.1 to 0.65 of this bending, with the same sign. The
    peak at the fillet is not included.

    References
    ----------
    [derived] offset and inward load on two equal walls

    Examples
    --------
    >>> axial, bending = neck_stresses(force=7273.57, outer_radius=10.5e-3, wall_thickness=2e-3,
    ...                                crest_radius=13.5e-3, valley_radius=11e-3,
    ...                                flank_distance=2.22e-3, angle=1.0471975511965976)
    >>> print(f"{axial / 1e6:.2f} {bending / 1e6:.1f}")
    60.93 134.2
    """
    area = pi * wall_thickness * (2 * outer_radius - wall_thickness)
    lever = (crest_radius + valley_radius) / 2 - (outer_radius - wall_thickness / 2)
    lever = lever - flank_distance / tangent(angle)
    axial = force / area
    return axial, 3 * lever / wall_thickness * axial


@geometry
def cooling_play(
    *, expansion_difference: Array, cooling: Array, radius: Array, angle: Array
) -> Array:
    """Axial play by which cooling loosens the trap, (alpha_m - alpha_h) dT r/tan(psi).

    Parameters
    ----------
    expansion_difference : of the metal less that of the hoop plies, alpha_m - alpha_h [1/K]
    cooling : dT, positive [K]
    radius : r, of the crest [m]
    angle : psi, of the flank to the axis [rad]

    Returns
    -------
    length [m]

    Notes
    -----
    Valid: no preload, and no bond between metal and band.

    References
    ----------
    [derived] the metal shrinks away from hoop plies that do not

    Examples
    --------
    >>> d = cooling_play(expansion_difference=24.1e-6, cooling=100.0, radius=16.5e-3,
    ...                  angle=0.5235987755982988)
    >>> print(f"{d * 1e6:.2f}")
    68.88
    """
    return expansion_difference * cooling * radius / tangent(angle)
