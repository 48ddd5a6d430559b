"""Thin laminated wall: membrane stiffness, strains, growth, effective moduli.

Classical lamination theory of an axisymmetric tube without twist: every layer is isotropic or
a balanced +-angle pair. The theory is the fast substitute for the exact layered tube. Its error
is on the unsafe side at the bore and grows with t/r_i; above `THIN_WALL_LIMIT` the evaluation
warns. Plies are in `ply`, the burst is in `burst_ladder`.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import pi
from typing import Any, TypeAlias

from ..base.numeric import Array, geometry

THIN_WALL_LIMIT = 0.05
"""t/r_i above which the thin laminate should be replaced by the exact layered tube."""

Membrane: TypeAlias = tuple[Array, Array, Array]
"""Membrane stiffnesses Azz, Azt, Att of a wall [N/m]."""


@geometry
def membrane(*, plies: Sequence[Sequence[Any]], thicknesses: Sequence[Array]) -> Membrane:
    """Membrane stiffness of a wall of isotropic layers and balanced pairs.

    A_ij = sum Q_ij,k t_k for zz, zt, tt.

    Parameters
    ----------
    plies : stiffness of each layer in tube axes, Qzz, Qzt, Qtt first, as from `ply.rotated` [Pa]
    thicknesses : thickness of each layer [m]; of a pair, both plies together

    Returns
    -------
    Azz, Azt, Att [N/m]

    Notes
    -----
    Valid: thin walls.

    References
    ----------
    [Jones1999] extensional stiffness

    Examples
    --------
    >>> q = (100e9, 30e9, 100e9)
    >>> print(*(f"{a / 1e6:.1f}" for a in membrane(plies=[q, q], thicknesses=[1e-3, 2e-3])))
    300.0 90.0 300.0
    """
    axial: Array = 0.0
    cross: Array = 0.0
    hoop: Array = 0.0
    for ply, thickness in zip(plies, thicknesses, strict=True):
        axial = axial + ply[0] * thickness
        cross = cross + ply[1] * thickness
        hoop = hoop + ply[2] * thickness
    return axial, cross, hoop


def strains(
    *, membrane: Membrane, axial_line_force: Array, hoop_line_force: Array
) -> tuple[Array, Array]:
    """Strains of a wall under line forces, without twist or bending.

    e = A^-1 (N_z, N_t).

    Parameters
    ----------
    membrane : Azz, Azt, Att [N/m]
    axial_line_force : N_z = N/(2 pi r), thermal line forces added [N/m]
    hoop_line_force : N_t = p r, thermal line forces added [N/m]

    Returns
    -------
    axial and hoop strain [-]

    Notes
    -----
    Valid: thin walls. r is a choice: the mid-radius for strength, the bore for bore growth.

    References
    ----------
    [Jones1999] membrane of a balanced laminate

    Examples
    --------
    >>> ez, et = strains(membrane=(3e8, 9e7, 3e8), axial_line_force=0.0, hoop_line_force=1e5)
    >>> print(f"{ez:.4e} {et:.4e}")
    -1.0989e-04 3.6630e-04
    """
    axial, cross, hoop = membrane
    inverse = 1 / (axial * hoop - cross * cross)
    return (
        (hoop * axial_line_force - cross * hoop_line_force) * inverse,
        (axial * hoop_line_force - cross * axial_line_force) * inverse,
    )


@geometry
def thermal_line_forces(
    *,
    loads: Sequence[tuple[Array, Array]],
    thicknesses: Sequence[Array],
    temperature_change: Array,
) -> tuple[Array, Array]:
    """Line forces that a temperature change adds to the mechanical ones in `strains`.

    N_T = dT sum K_k t_k. The stress of a ply then follows from the strain minus its alpha dT.

    Parameters
    ----------
    loads : K_z, K_t of each layer, from `ply.thermal_ply_load` [Pa/K]
    thicknesses : thickness of each layer [m]
    temperature_change : dT from the stress-free state [K]

    Returns
    -------
    axial and hoop thermal line force [N/m]

    Notes
    -----
    Valid: constant properties, uniform temperature.

    References
    ----------
    [Jones1999] thermal forces

    Examples
    --------
    >>> nz, nt = thermal_line_forces(loads=[(2e6, 2e6)], thicknesses=[1e-3],
    ...                              temperature_change=-100.0)
    >>> print(f"{nz:.0f} {nt:.0f}")
    -200000 -200000
    """
    axial: Array = 0.0
    hoop: Array = 0.0
    for (axial_load, hoop_load), thickness in zip(loads, thicknesses, strict=True):
        axial = axial + axial_load * thickness
        hoop = hoop + hoop_load * thickness
    return axial * temperature_change, hoop * temperature_change


@geometry
def bore_growth_thin(
    *, pressure: Array, inner_radius: Array, axial_force: Array, membrane: Membrane
) -> Array:
    """Radial growth of the bore of a thin laminated tube.

    u = r_i e_t under N_t = p r_i, N_z = N/(2 pi r_i), with the bore radius throughout (a choice).

    Parameters
    ----------
    pressure : internal gauge pressure [Pa]
    inner_radius : bore radius [m]
    axial_force : tensile force in the wall [N]
    membrane : Azz, Azt, Att [N/m]

    Returns
    -------
    radial growth [m]

    Notes
    -----
    Valid: t/r_i < 0.05; on the unsafe side beyond.

    By exact theory, an all-hoop CFRP tube grows 1/0.89, 1/0.76 and 1/0.53 times as much at the wall
    ratios k = 1.1, 1.2 and 1.4.

    References
    ----------
    [derived] membrane equilibrium at the bore

    Examples
    --------
    >>> u = bore_growth_thin(pressure=10e6, inner_radius=10e-3, axial_force=0.0,
    ...                      membrane=(3e8, 9e7, 3e8))
    >>> print(f"{u * 1e6:.3f} um")
    3.663 um
    """
    _, hoop_strain = strains(
        membrane=membrane,
        axial_line_force=axial_force / (2 * pi * inner_radius),
        hoop_line_force=pressure * inner_radius,
    )
    return inner_radius * hoop_strain


@geometry
def effective_moduli(*, membrane: Membrane, thickness: Array) -> tuple[Array, Array, Array]:
    """Axial and hoop modulus of a wall, each without force in the other direction, and nu_zt nu_tz.

    E_z = (Azz - Azt^2/Att)/t, E_t = (Att - Azt^2/Azz)/t, nu_zt nu_tz = Azt^2/(Azz Att).

    Parameters
    ----------
    membrane : Azz, Azt, Att [N/m]
    thickness : thickness of the whole wall [m]

    Returns
    -------
    axial modulus [Pa], hoop modulus [Pa], product of Poisson's ratios [-]

    Notes
    -----
    Valid: thin walls.

    References
    ----------
    [Jones1999] laminate moduli

    Examples
    --------
    >>> ez, et, product = effective_moduli(membrane=(3e8, 9e7, 3e8), thickness=3e-3)
    >>> print(f"{ez / 1e9:.2f} {et / 1e9:.2f} {product:.2f}")
    91.00 91.00 0.09
    """
    axial, cross, hoop = membrane
    product = cross * cross / (axial * hoop)
    stiff = (1 - product) / thickness
    return axial * stiff, hoop * stiff, product


@geometry
def bending_stiffness(*, plies: Sequence[Sequence[Any]], thicknesses: Sequence[Array]) -> Array:
    """Axial bending stiffness of a wall per length of circumference, about its neutral surface.

    D = sum Qzz (t^3/12 + t (y - y_0)^2), y_0 = sum Qzz t y/sum Qzz t; no hoop curvature.

    Parameters
    ----------
    plies : stiffness of each layer in tube axes, Qzz first, from the bore outwards [Pa]
    thicknesses : thickness of each layer [m]

    Returns
    -------
    D_z [N m]

    Notes
    -----
    Valid: thin walls; the coupling of hoop strain and axial bending moment is neglected.

    References
    ----------
    [Jones1999] bending stiffness, shifted to the neutral surface

    Examples
    --------
    >>> print(f"{bending_stiffness(plies=[(1e11,), (1e11,)], thicknesses=[1e-3, 2e-3]):.1f}")
    225.0
    """
    depth: Array = 0.0
    zeroth: Array = 0.0
    first: Array = 0.0
    second: Array = 0.0
    for ply, thickness in zip(plies, thicknesses, strict=True):
        line = ply[0] * thickness
        middle = depth + thickness / 2
        zeroth = zeroth + line
        first = first + line * middle
        second = second + line * (middle * middle + thickness * thickness / 12)
        depth = depth + thickness
    return second - first * first / zeroth
