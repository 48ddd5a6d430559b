"""Cylinder and rod as a beam under its own weight, a side load and an off-centre push.

The moment without the push grows by a factor that is approximate for any shape of load but that
of the buckling mode. A side force at the rod's eye, carried by the guides, is the moment F times
overhang at the head. Critical loads come from `stepped`.
"""

from __future__ import annotations

from ..base.numeric import Array, geometry, positive, real, where


@geometry
def self_weight_moments(
    *, weight_1: Array, length_1: Array, weight_2: Array, length_2: Array
) -> tuple[Array, Array, Array]:
    """Bending moments of a horizontal cylinder, pinned at both eyes, under its own weight.

    At the joint M = L1 L2 (w1 L1 + w2 L2)/(2 L); with the reaction R_i = M/L_i + w_i L_i/2 of
    each pin, the largest of a segment is R_i^2/(2 w_i) where R_i < w_i L_i, else that at the joint.

    Parameters
    ----------
    weight_1, weight_2 : weight per length of barrel (with oil) and rod [N/m]
    length_1, length_2 : from the barrel's eye to the head, from there to the rod's eye [m]

    Returns
    -------
    at the joint, largest in segment 1, largest in segment 2 [N m]

    Notes
    -----
    Valid: horizontal, pinned at both ends, each weight even along its segment.

    References
    ----------
    [derived] equilibrium of a beam on two supports

    Examples
    --------
    >>> moments = self_weight_moments(weight_1=40.0, length_1=0.8, weight_2=25.0, length_2=0.6)
    >>> print(*(f"{m:.3f}" for m in moments))
    8.057 8.496 8.057
    """
    joint = length_1 * length_2 / (length_1 + length_2)
    joint = joint * (weight_1 * length_1 + weight_2 * length_2) / 2

    def largest(weight: Array, length: Array) -> Array:
        load = weight * length
        reaction = joint / length + load / 2
        inside = real(reaction) < real(load)
        divisor = where(inside, weight, 0 * weight + 1)
        return where(inside, reaction * reaction / (2 * divisor), joint)

    return joint, largest(weight_1, length_1), largest(weight_2, length_2)


def amplified_moment(
    *, bending_moment: Array, axial_force: Array, critical_load: Array, shape: Array = 0.0
) -> Array:
    """Bending moment of a column that already bends without its push.

    M (1 + psi P/P_cr)/(1 - P/P_cr): exact for the moment of a uniform column that looks like its
    buckling mode. Uniform and pinned, at mid-span: psi = 0.03 for an even load, -0.18 for a load
    in the middle, 4/pi - 1 (safe) for a push off-centre at both ends.

    Parameters
    ----------
    bending_moment : M, largest without the push [N m]
    axial_force : P, push positive [N]
    critical_load : P_cr of the same column [N]
    shape : psi [-]

    Returns
    -------
    moment [N m]; NaN at and above the critical load

    Notes
    -----
    Valid: P < P_cr; elastic.

    Largest moment in the rod of a stepped cylinder, psi = 0, P/P_cr to 1/3.5: under its weight
    from 4 % low to 14 % high, under a push off-centre at both ends 4 to 8 % low.

    References
    ----------
    [TimoshenkoGere1961] beam-columns, approximate formula

    Examples
    --------
    >>> m = amplified_moment(bending_moment=10.0, axial_force=9e3, critical_load=30e3)
    >>> print(f"{m:.3f} N m")
    14.286 N m
    """
    ratio = axial_force / critical_load
    return bending_moment * (1 + shape * ratio) / positive(1 - ratio)


@geometry
def bending_axial_force(
    *, bending_moment: Array, radius: Array, axial_stiffness: Array, bending_stiffness: Array
) -> Array:
    """Axial force that strains the whole section as bending strains its fibre at a radius.

    N = M r EA/EI. Added to the axial force of a layered tube it gives the plies' stresses on the
    side bent most; of one material, M A r/I.

    Parameters
    ----------
    bending_moment : M [N m]
    radius : r, of the fibre, the outer radius for the largest [m]
    axial_stiffness : EA of the section [N]
    bending_stiffness : EI of the section [N m^2]

    Returns
    -------
    axial force [N]

    Notes
    -----
    Valid: linear elastic, slender; the strain of one fibre is taken for the whole section.

    References
    ----------
    [derived] strain M r/EI equals strain N/EA

    Examples
    --------
    >>> n = bending_axial_force(bending_moment=20.0, radius=8e-3, axial_stiffness=9.32e6,
    ...                         bending_stiffness=215.4)
    >>> print(f"{n / 1e3:.3f} kN")
    6.923 kN
    """
    return bending_moment * radius * axial_stiffness / bending_stiffness
