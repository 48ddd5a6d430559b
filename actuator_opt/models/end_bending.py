"""Bending of a layered wall near its end, where a clamp or a step prevents its growth.

The wall is a shell with first-order shear. Per circumference, it has the axial bending stiffness D
about its stiffness centre z_n, the hoop stiffness k per radial displacement, and the transverse
shear stiffness S. Distances z are from the bore. The bending decays within a few multiples of
1/beta = (4 D/k)^(1/4).
"""

from __future__ import annotations

from collections.abc import Sequence
from math import exp, pi

from ..base.dataclass import dataclass
from ..base.numeric import Array, absolute, geometry, maximum, minimum, sqrt


@dataclass(frozen=True, slots=True)
class ShellLayer:
    """A layer: thickness [m], and plane-stress stiffness in the axes of the wall [Pa].

    Q_zz is axial, Q_tt in the hoop direction, Q_zt couples both; `shear` is G_rz. `angle` is the
    winding angle of plies [rad], 0 for a metal.
    """

    thickness: Array
    axial: Array
    hoop: Array
    coupling: Array
    shear: Array
    angle: Array = 0.0


@dataclass(frozen=True, slots=True)
class Shell:
    """Stiffnesses of a wall, per circumference.

    D is `bending` [N m], k `foundation` [Pa/m], S `shear` [N/m], z_n `centre`, the distance of the
    stiffness centre from the bore [m], and R `radius`, of the middle [m]. A_zz and A_zt are `axial`
    and `coupling` [N/m].
    """

    bending: Array
    foundation: Array
    shear: Array
    centre: Array
    radius: Array
    axial: Array
    coupling: Array


@dataclass(frozen=True, slots=True)
class Edge:
    """State of a wall at its edge, per circumference.

    `growth` is its radial displacement [m], `moment` bends the bore into tension [N], and `force`
    is the transverse shear force [N/m].
    """

    growth: Array
    moment: Array
    force: Array


@geometry
def shell(*, layers: Sequence[ShellLayer], inner_radius: Array) -> Shell:
    """Stiffnesses of a layered wall against axisymmetric bending.

    A_ij = sum Q_ij t; z_n = sum Q_zz t z_m/A_zz; D = sum Q_zz int (z - z_n)^2 dz;
    k = (A_tt - A_zt^2/A_zz)/R^2; 1/S = int g^2/G_rz dz/D^2, g = int_0^z Q_zz (z - z_n) dz.

    Parameters
    ----------
    layers : layers from the bore outwards
    inner_radius : of the wall [m]; R is that of its middle

    Returns
    -------
    stiffnesses, stiffness centre [m] and radius [m] of the wall

    Notes
    -----
    Valid: balanced layers, R at least 2.5 wall thicknesses.

    Between z_a and z_b of a layer, g = c + Q_zz u^2/2 with u = z - z_n, so that the integral of g^2
    has a closed form.

    References
    ----------
    [Timoshenko1959] cylindrical shell under axisymmetric load; [derived] layers and shear

    Examples
    --------
    >>> metal = ShellLayer(1.5e-3, 80.46e9, 80.46e9, 26.55e9, 26.95e9)
    >>> wall = shell(layers=[metal], inner_radius=16e-3)
    >>> print(f"{wall.bending:.4f} {wall.foundation / 1e9:.2f} {wall.shear / 1e6:.4f}")
    22.6294 383.33 33.6875
    """
    zz = sum(layer.axial * layer.thickness for layer in layers)
    zt = sum(layer.coupling * layer.thickness for layer in layers)
    tt = sum(layer.hoop * layer.thickness for layer in layers)
    moment, place = 0.0, 0.0
    for layer in layers:
        moment = moment + layer.axial * layer.thickness * (place + layer.thickness / 2)
        place = place + layer.thickness
    centre, radius = moment / zz, inner_radius + place / 2
    bending, give, carried, place = 0.0, 0.0, 0.0, 0.0
    for layer in layers:
        low, high = place - centre, place + layer.thickness - centre
        low3, high3 = low * low * low, high * high * high
        bending = bending + layer.axial * (high3 - low3) / 3
        constant = carried - layer.axial * low * low / 2
        give = (
            give
            + (
                constant * constant * (high - low)
                + constant * layer.axial * (high3 - low3) / 3
                + layer.axial * layer.axial * (high3 * high * high - low3 * low * low) / 20
            )
            / layer.shear
        )
        carried = constant + layer.axial * high * high / 2
        place = place + layer.thickness
    return Shell(
        bending=bending,
        foundation=(tt - zt * zt / zz) / (radius * radius),
        shear=bending * bending / give,
        centre=centre,
        radius=radius,
        axial=zz,
        coupling=zt,
    )


@geometry
def free_growth(*, wall: Shell, pressure: Array, bore_radius: Array, line_force: Array) -> Array:
    """Radial growth of a wall far from its ends, w = (p r_i - N A_zt/A_zz)/(k R).

    Parameters
    ----------
    wall : from `shell`
    pressure : p at the bore [Pa]
    bore_radius : r_i [m]
    line_force : axial force per circumference, N [N/m]

    Returns
    -------
    displacement [m]

    Notes
    -----
    Valid: thin walls; within 15 % of the exact tube at R = 2.8 wall thicknesses.

    References
    ----------
    [derived] membrane equilibrium, N_t = p r_i

    Examples
    --------
    >>> metal = ShellLayer(1.5e-3, 80.46e9, 80.46e9, 26.55e9, 26.95e9)
    >>> wall = shell(layers=[metal], inner_radius=16e-3)
    >>> w = free_growth(wall=wall, pressure=28e6, bore_radius=16e-3, line_force=0.0)
    >>> print(f"{w * 1e6:.3f}")
    69.773
    """
    around = pressure * bore_radius - line_force * wall.coupling / wall.axial
    return around / (wall.foundation * wall.radius)


def clamped(*, wall: Shell, growth: Array) -> Edge:
    """Edge of a wall at a rigid clamp.

    M_0 = sqrt(k D) w/(1 + sqrt(k D)/S); Q_0 = 2 a k w/(2 beta^2 + k/S), with beta^4 = k/(4 D) and
    a^2 = beta^2 + k/(4 S).

    Parameters
    ----------
    wall : from `shell`
    growth : w, radial growth far from the clamp [m]

    Returns
    -------
    the edge: growth 0 [m], M_0 [N] and Q_0 [N/m]

    Notes
    -----
    Valid: as `shell`; axisymmetric finite elements give 0.86 to 1.2 of the moment.

    At a sharp corner, the elastic stress has a peak that is not included.

    References
    ----------
    [Timoshenko1959] clamped edge of a long cylindrical shell; [derived] with first-order shear

    Examples
    --------
    >>> metal = Shell(22.63, 383.337e9, 33.75e6, 0.75e-3, 16.75e-3, 120.7e6, 39.8e6)
    >>> print(f"{clamped(wall=metal, growth=73.0428e-6).moment:.3f}")
    197.867
    """
    middle = sqrt(wall.foundation * wall.bending)
    beta2 = middle / (2 * wall.bending)
    root = sqrt(beta2 + wall.foundation / (4 * wall.shear))
    moment = middle * growth / (1 + middle / wall.shear)
    force = 2 * root * wall.foundation * growth / (2 * beta2 + wall.foundation / wall.shear)
    return Edge(0.0 * growth, moment, force)


def stepped(
    *,
    left: Shell,
    right: Shell,
    left_growth: Array,
    right_growth: Array,
    offset_moment: Array,
) -> Edge:
    """Edge of the right wall where two long walls meet.

    Each wall has K = D/(1 + sqrt(k D)/S) [[4 a beta^2, -+2 beta^2], [-+2 beta^2, 2 a]] for
    displacement and rotation of its edge, upper sign on the left, with a^2 = beta^2 + k/(4 S).
    (K_1 + K_2) (w, theta) = K_1 (w_1, 0) + K_2 (w_2, 0) - (0, m).

    Parameters
    ----------
    left, right : walls, from `shell`
    left_growth, right_growth : w_1 and w_2, free growth far from the step [m]
    offset_moment : m = N (R_2 - R_1) of the line force N at the stiffness centres of both walls [N]

    Returns
    -------
    the edge of the right wall: growth [m], moment [N] and shear force [N/m]

    Notes
    -----
    Valid: as `shell`; each wall longer than 3/beta.

    References
    ----------
    [Timoshenko1959] edge stiffness of a long cylindrical shell; [derived] continuity, shear

    Examples
    --------
    >>> left = Shell(20.0, 400e9, 1e15, 0.0, 1e-2, 1e8, 3e7)
    >>> right = Shell(160.0, 800e9, 1e15, 0.0, 1e-2, 2e8, 6e7)
    >>> edge = stepped(left=left, right=right, left_growth=10e-6, right_growth=5e-6,
    ...                offset_moment=82.5)
    >>> print(f"{edge.growth * 1e6:.5f} {edge.moment:.4f}")
    9.02837 65.5957
    """
    first, second = _edge(left), _edge(right)
    stiff, cross, turn = first[0] + second[0], second[1] - first[1], first[2] + second[2]
    push = first[0] * left_growth + second[0] * right_growth
    twist = second[1] * right_growth - first[1] * left_growth - offset_moment
    determinant = stiff * turn - cross * cross
    growth = (push * turn - cross * twist) / determinant
    slope = (stiff * twist - cross * push) / determinant
    change = right_growth - growth
    return Edge(
        growth,
        second[1] * change - second[2] * slope,
        second[0] * change - second[1] * slope,
    )


def _edge(wall: Shell) -> tuple[Array, Array, Array]:
    """4 D a beta^2, 2 D beta^2 and 2 D a of a wall, each divided by 1 + sqrt(k D)/S."""
    middle = sqrt(wall.foundation * wall.bending)  # 2 D beta^2
    root = sqrt(middle / (2 * wall.bending) + wall.foundation / (4 * wall.shear))
    share = 1 / (1 + middle / wall.shear)
    return 2 * middle * root * share, middle * share, 2 * wall.bending * root * share


def edge_stresses(
    *, layer: ShellLayer, start: Array, wall: Shell, edge: Edge, line_force: Array
) -> tuple[tuple[Array, Array], tuple[Array, Array]]:
    """Axial and hoop stress of a layer at the edge of its wall, at both faces.

    e_t = w/R; e_z = (N - A_zt e_t)/A_zz + M (z_n - z)/D; sigma_z = Q_zz e_z + Q_zt e_t and
    sigma_t = Q_zt e_z + Q_tt e_t.

    Parameters
    ----------
    layer : layer of the wall
    start : distance of the layer's inner face from the bore [m]
    wall : from `shell`
    edge : from `clamped` or `stepped`
    line_force : axial force per circumference, N [N/m]

    Returns
    -------
    (sigma_z, sigma_t) at the inner and at the outer face [Pa]

    Notes
    -----
    Valid: as `shell`, plane stress.

    References
    ----------
    [derived] Hooke's law of the layer in the bent wall

    Examples
    --------
    >>> metal = ShellLayer(1.5e-3, 80.46e9, 80.46e9, 26.55e9, 26.95e9)
    >>> wall = shell(layers=[metal], inner_radius=16e-3)
    >>> inner, outer = edge_stresses(layer=metal, start=0.0, wall=wall,
    ...                              edge=Edge(0.0, 200.0, 0.0), line_force=0.0)
    >>> print(f"{inner[0] / 1e6:.1f} {outer[0] / 1e6:.1f}")
    533.3 -533.3
    """
    around = edge.growth / wall.radius
    along = (line_force - wall.coupling * around) / wall.axial
    faces = []
    for place in (start, start + layer.thickness):
        strain = along + edge.moment * (wall.centre - place) / wall.bending
        faces.append(
            (
                layer.axial * strain + layer.coupling * around,
                layer.coupling * strain + layer.hoop * around,
            )
        )
    return faces[0], faces[1]


def groove_shear(*, wall: Shell, growth: Array, groove_moment: Array) -> Array:
    """Upper bound of the shear force in a wall that holds a plug in a groove or thread of its bore.

    Pressure ends at the plug's seal: k w/(4 a). The plug's force enters at the bore, with the
    moment N e: at most sqrt 2 e^(-pi/4) beta N e. The bound is their sum.

    Parameters
    ----------
    wall : from `shell`
    growth : w, radial growth inside the pressurised length [m]
    groove_moment : N e of the line force and its distance from the stiffness centre [N]

    Returns
    -------
    shear force per circumference [N/m]

    Notes
    -----
    Valid: as `shell`; both parts peak at different places. Shear compliance lowers the second one.

    References
    ----------
    [Timoshenko1959] long cylindrical shell, pressure on one half, and moment at a free end;
    [derived] shear compliance, a as for `clamped`

    Examples
    --------
    >>> wall = Shell(20.0, 320e9, 1e12, 1e-3, 1e-2, 1e8, 3e7)
    >>> print(f"{groove_shear(wall=wall, growth=4e-6, groove_moment=50.0):.1f}")
    9380.3
    """
    middle = sqrt(wall.foundation * wall.bending)
    beta2 = middle / (2 * wall.bending)
    step = wall.foundation * growth / (4 * sqrt(beta2 + wall.foundation / (4 * wall.shear)))
    return step + 2**0.5 * exp(-pi / 4) * sqrt(beta2) * groove_moment


def strain_changes(*, place: Array, wall: Shell, edge: Edge, growth: Array) -> tuple[Array, Array]:
    """Axial and hoop strain at the edge of a wall, minus those far from it.

    de_t = (w_edge - w)/R; de_z = -A_zt de_t/A_zz + M (z_n - z)/D.

    Parameters
    ----------
    place : z, distance from the bore [m]
    wall : from `shell`
    edge : from `clamped` or `stepped`
    growth : w, radial growth far from the edge [m]

    Returns
    -------
    de_z, de_t [-]

    Notes
    -----
    Valid: as `shell`; the axial force is the same at the edge and far from it.

    References
    ----------
    [derived] plane sections of the bent wall

    Examples
    --------
    >>> wall = Shell(20.0, 320e9, 1e12, 1e-3, 1e-2, 1e8, 3e7)
    >>> axial, hoop = strain_changes(place=0.0, wall=wall, edge=Edge(0.0, 50.0, 0.0), growth=4e-6)
    >>> print(f"{axial:.5f} {hoop:.5f}")
    0.00262 -0.00040
    """
    around = (edge.growth - growth) / wall.radius
    bent = edge.moment * (wall.centre - place) / wall.bending
    return bent - wall.coupling * around / wall.axial, around


def interlaminar_shear(
    *, layers: Sequence[ShellLayer], wall: Shell, force: Array
) -> tuple[Array, ...]:
    """Largest shear stress through the thickness of each layer.

    tau = |Q g|/D, g = int_0^z Q_zz (z - z_n) dz, at the point of the layer nearest to z_n; 1.5 Q/t
    in a homogeneous wall.

    Parameters
    ----------
    layers : layers from the bore outwards, as for `shell`
    wall : from `shell`
    force : Q, transverse shear force per circumference [N/m]

    Returns
    -------
    tau [Pa], by layer

    Notes
    -----
    Valid: as `shell`; singular peaks at corners are not included.

    References
    ----------
    [Timoshenko1959] shear flow of a bent section; [derived] layers

    Examples
    --------
    >>> metal = ShellLayer(2e-3, 80e9, 80e9, 26e9, 27e9)
    >>> wall = shell(layers=[metal], inner_radius=10e-3)
    >>> shear, = interlaminar_shear(layers=[metal], wall=wall, force=1e4)
    >>> print(f"{shear / 1e6:.3f}")
    7.500
    """
    stresses = []
    carried, place = 0.0, 0.0
    for layer in layers:
        low, high = place - wall.centre, place + layer.thickness - wall.centre
        nearest = minimum(maximum(low, 0.0), high)
        flow = carried + layer.axial * (nearest * nearest - low * low) / 2
        stresses.append(absolute(force * flow) / wall.bending)
        carried = carried + layer.axial * (high * high - low * low) / 2
        place = place + layer.thickness
    return tuple(stresses)


MOST_WINDING = 10.0
"""Largest thickness of a winding, divided by that of its liner, for `thickened_end_peak`."""


@geometry
def thickened_end_peak(*, length: Array, radius: Array, thickness: Array) -> Array:
    """Largest equivalent stress of a liner beside its thickened end, divided by that far from it.

    1.35 max(1, 1.25/x), x = L/sqrt(R T). The winding does not yet carry its share there, and the
    middle of the metal steps, both of which a shell leaves out. If the end is short, the couple of
    the force on its thread turns it as a whole, and bends the liner beside it.

    Parameters
    ----------
    length : L of the end, with its thread and its conical tip [m]
    radius : R of the bore [m]
    thickness : T of the end, with the winding [m]

    Returns
    -------
    factor [-]

    Notes
    -----
    Valid: L above 0.47 sqrt(R T), winding up to `MOST_WINDING` times as thick as the liner.

    Upper bound of finite elements of 63 ends on bores of 20 to 120 mm, by 1 % to 35 % for x above
    1.25; liners of 7075, hoop windings of carbon, tips of 1:5.

    References
    ----------
    [derived] envelope of own finite elements

    Examples
    --------
    >>> factor = thickened_end_peak(length=13.9e-3, radius=11.1e-3, thickness=6.35e-3)
    >>> print(f"{factor:.2f}")
    1.35
    """
    relative = length / sqrt(radius * thickness)
    return 1.35 * maximum(1.25 / relative, 1.0 + 0.0 * relative)
