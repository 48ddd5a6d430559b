"""Bounds on layered tubes: bore growth, axial stiffness and pressure before damage.

They are energy bounds: any compatible displacement stores at least the energy of the true
displacement, and any equilibrium stress at least the true complementary energy [Gurtin1972]. The
bounds are sums over the layers, so they are valid for every thickness and radius.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import sqrt

from ..base.numeric import Array, geometry, namespace
from .mass import layer_area


@geometry
def least_growth(
    *,
    hoop: Sequence[Array],
    cross: Sequence[Array],
    radial: Sequence[Array],
    decays: Sequence[Sequence[float]],
    thicknesses: Sequence[Array],
    inner_radius: Array,
) -> Array:
    """Lower bound on a layered tube's radial bore growth per unit pressure.

    With the bore pressure p and the outer radius r_k of layer k, the bore grows by
    u >= p r_i/sum K_k a_k (1 - x_k^(-2 b_k))/(2 b_k), K_k = C_tt - 2 b_k C_tr + b_k^2 C_rr,
    x_k = r_k/r_(k-1), a_k = prod x_j^(-2 b_j) over all layers inside k. This is the energy of the
    trial displacement that falls as r^(-b_k), with no axial strain. Each layer may be cut into
    equal parts, each with its own b.

    Parameters
    ----------
    hoop, cross, radial : stiffnesses C_tt, C_tr, C_rr of each layer from the bore outwards [Pa]
    decays : exponents b of the parts of each layer, not zero [-]
    thicknesses : of each layer [m]
    inner_radius : r_i [m]

    Returns
    -------
    lower bound on the bore's radial growth per unit pressure, for a tube held axially or free
    [m/Pa]

    Notes
    -----
    Valid: linear elastic, bonded layers without twist.

    References
    ----------
    [derived] minimum potential energy; the trial displacement is one power of r in each part

    Examples
    --------
    >>> u = least_growth(hoop=[282.7e9], cross=[121.2e9], radial=[282.7e9], decays=[[0.4]],
    ...                  thicknesses=[4e-3], inner_radius=16e-3)
    >>> print(f"{u * 28e6 * 1e6:.3f} um")
    9.491 um
    """
    total: Array = 0.0
    share: Array = 1.0
    radius = inner_radius
    for tt, tr, rr, falls, thickness in zip(hoop, cross, radial, decays, thicknesses, strict=True):
        part = thickness / radius / len(falls)
        own: Array = 0.0  # as a function of t/r alone, so that it is one curve of a relaxation
        left: Array = 1.0
        inside: Array = 1.0
        for number, b in enumerate(falls, start=1):
            outside = 1 + number * part
            fall = (outside / inside) ** (-2 * b)
            own = own + (tt - 2 * b * tr + b * b * rr) * (left * ((1 - fall) / (2 * b)))
            left, inside = left * fall, outside
        total = total + share * own
        share, radius = share * left, radius + thickness
    return inner_radius / total


@geometry
def axial_stiffness(
    *, moduli: Sequence[Array], thicknesses: Sequence[Array], inner_radius: Array
) -> Array:
    """Axial stiffness of layers in parallel: sum of q_k A_k, modulus times cross-section area.

    For a bonded tube the sum is a lower bound if q_k are the moduli of layers that are free to
    contract, and an upper bound if they are the moduli of layers that all contract alike. With
    q_k = C_zz it is an upper bound for a tube that cannot move radially.

    Parameters
    ----------
    moduli : q_k of each layer from the bore outwards [Pa]
    thicknesses : of each layer [m]
    inner_radius : r_i [m]

    Returns
    -------
    EA [N]

    Notes
    -----
    Valid: linear elastic, bonded layers without twist.

    References
    ----------
    [derived] complementary energy of uniaxial stress, potential energy of uniform contraction

    Examples
    --------
    >>> k = axial_stiffness(moduli=[70e9, 10e9], thicknesses=[1e-3, 1e-3], inner_radius=10e-3)
    >>> print(f"{k / 1e6:.3f} MN")
    5.341 MN
    """
    total: Array = 0.0
    radius = inner_radius
    for modulus, thickness in zip(moduli, thicknesses, strict=True):
        total = total + modulus * layer_area(inner_radius=radius, thickness=thickness)
        radius = radius + thickness
    return total


def ply_hoop_strength(
    *, tension_1: Array, tension_2: Array, shear_12: Array, angle: Array
) -> Array:
    """Largest hoop stress of a ply that meets the maximum-stress criterion.

    S = (X_t + Y_t)/2 - (X_t - Y_t)/2 cos 2a + S_12 sin 2a.

    Parameters
    ----------
    tension_1, tension_2, shear_12 : strengths X_t, Y_t, S_12 [Pa]
    angle : a, winding angle from the tube axis, 0 to pi/2 [rad]

    Returns
    -------
    stress [Pa]

    Notes
    -----
    Valid: any ply that fails when one stress reaches the strength in its direction.

    References
    ----------
    [derived] hoop stress from ply stresses that are all at their strengths

    Examples
    --------
    >>> s = ply_hoop_strength(tension_1=1900e6, tension_2=55e6, shear_12=85e6,
    ...                       angle=1.5707963)
    >>> print(f"{s / 1e6:.0f} MPa")
    1900 MPa
    """
    xp = namespace(angle)
    mean, half = (tension_1 + tension_2) / 2, (tension_1 - tension_2) / 2
    return mean - half * xp.cos(2 * angle) + shear_12 * xp.sin(2 * angle)


@geometry
def greatest_pressure(
    *,
    yields: Sequence[Array | None],
    hoops: Sequence[Array | None],
    thicknesses: Sequence[Array],
    inner_radius: Array,
) -> Array:
    """Upper bound on the pressure that a layered tube bears before its first damage.

    From the outer face (p_n = 0) inwards, the pressure p_(k-1) on the inner face of a layer is
    p_k r_k/r_(k-1) + S_k t_k/r_(k-1) for a ply of thickness t_k, and
    p_k + (2/sqrt(3)) sigma_y ln(r_k/r_(k-1)) for a metal layer.

    Parameters
    ----------
    yields : sigma_y of each metal layer from the bore outwards, None for a ply [Pa]
    hoops : S_k of each ply, None for a metal layer [Pa]
    thicknesses : of each layer [m]
    inner_radius : r_i [m]

    Returns
    -------
    pressure [Pa]

    Notes
    -----
    Valid: C_tt >= C_rr; axial and thermal strain alone cause no hoop stress above S_k in any ply.

    Each layer is in equilibrium. In a ply d(r sigma_r)/dr = sigma_t, and the mean of sigma_t
    through the ply is at most the larger of its values at the two faces. In a metal d sigma_r/dr =
    (sigma_t - sigma_r)/r, which von Mises limits.

    References
    ----------
    [derived] equilibrium of each layer in turn

    Examples
    --------
    >>> p = greatest_pressure(yields=[240e6, None], hoops=[None, 1900e6],
    ...                       thicknesses=[0.6e-3, 1.2e-3], inner_radius=16e-3)
    >>> print(f"{p / 1e5:.0f} bar")
    1476 bar
    """
    radii = [inner_radius]
    for thickness in thicknesses:
        radii.append(radii[-1] + thickness)
    pressure: Array = 0.0
    layers = list(zip(yields, hoops, thicknesses, radii[:-1], radii[1:], strict=True))
    for strength, hoop, thickness, inside, outside in reversed(layers):
        ratio = thickness / inside
        if strength is not None:
            pressure = pressure + 2 / sqrt(3) * strength * namespace(ratio).log1p(ratio)
        else:
            pressure = pressure * (outside / inside) + hoop * ratio
    return pressure
