"""What no layered tube of given layers can beat: least bore growth, axial stiffness between two.

Energy bounds: any displacement that fits together stores at least the energy of the true one, any
stress in balance the complementary energy [Gurtin1972]. They are sums over the layers, so that
they hold for every thickness and radius at once.
"""

from __future__ import annotations

from collections.abc import Sequence

from ..numeric import Array
from .rod import section_area


def least_growth(
    *,
    hoop: Sequence[Array],
    cross: Sequence[Array],
    radial: Sequence[Array],
    decays: Sequence[float],
    thicknesses: Sequence[Array],
    inner_radius: Array,
) -> Array:
    """Bore growth per pressure of a layered tube without axial force, from below.

    u >= p r_i/sum K_k a_k (1 - x_k^(-2 b_k))/(2 b_k), K_k = C_tt - 2 b_k C_tr + b_k^2 C_rr,
    x_k = r_k/r_(k-1), a_k = prod x_j^(-2 b_j) over the layers inside: the energy of the trial
    displacement that falls as r^(-b_k) in each layer, with no axial strain.

    Parameters
    ----------
    hoop, cross, radial : stiffnesses C_tt, C_tr, C_rr of each layer from the bore outwards [Pa]
    decays : b_k of each layer, not zero [-]
    thicknesses : of each layer [m]
    inner_radius : r_i [m]

    Returns
    -------
    radial growth of the bore per pressure that is no more than the true one [m/Pa]

    Notes
    -----
    Valid: linear elastic, bonded layers without twist.

    References
    ----------
    [derived] minimum potential energy with a trial displacement of one power per layer

    Examples
    --------
    >>> u = least_growth(hoop=[282.7e9], cross=[121.2e9], radial=[282.7e9], decays=[0.4],
    ...                  thicknesses=[4e-3], inner_radius=16e-3)
    >>> print(f"{u * 28e6 * 1e6:.3f} um")
    9.491 um
    """
    total: Array = 0.0
    share: Array = 1.0
    radius = inner_radius
    for tt, tr, rr, b, thickness in zip(hoop, cross, radial, decays, thicknesses, strict=True):
        fall = (1 + thickness / radius) ** (-2 * b)
        stiff = tt - 2 * b * tr + b * b * rr
        total = total + stiff * share * ((1 - fall) / (2 * b))
        share, radius = share * fall, radius + thickness
    return inner_radius / total


def axial_stiffness_bounds(
    *,
    free: Sequence[Array],
    held: Sequence[Array],
    thicknesses: Sequence[Array],
    inner_radius: Array,
) -> tuple[Array, Array]:
    """Axial stiffness EA of a layered tube from below and from above.

    sum E_k A_k <= EA <= sum q_k A_k.

    Parameters
    ----------
    free : modulus E_k of each layer, free to contract [Pa]
    held : modulus q_k of each layer while all contract alike [Pa]
    thicknesses : of each layer [m]
    inner_radius : r_i [m]

    Returns
    -------
    EA from below and from above [N]

    Notes
    -----
    Valid: linear elastic, bonded layers without twist.

    References
    ----------
    [derived] complementary energy of uniaxial stress, potential energy of uniform contraction

    Examples
    --------
    >>> low, high = axial_stiffness_bounds(free=[70e9, 10e9], held=[72e9, 15e9],
    ...                                    thicknesses=[1e-3, 1e-3], inner_radius=10e-3)
    >>> print(f"{low / 1e6:.3f} {high / 1e6:.3f} MN")
    5.341 5.834 MN
    """
    low: Array = 0.0
    high: Array = 0.0
    bore = 2 * inner_radius
    for least, most, thickness in zip(free, held, thicknesses, strict=True):
        face = bore + 2 * thickness
        area = section_area(outer_diameter=face, inner_diameter=bore)
        low, high, bore = low + least * area, high + most * area, face
    return low, high
