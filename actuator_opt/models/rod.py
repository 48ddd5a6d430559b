"""Piston rod: section, stiffness, stresses and threads; also layered rods."""

from __future__ import annotations

from collections.abc import Sequence
from math import pi
from typing import Any

from ..base.numeric import Array, geometry


@geometry
def section_area(*, outer_diameter: Array, inner_diameter: Array = 0.0) -> Array:
    """Cross-section of a round bar or tube.

    A = pi (d_o^2 - d_i^2)/4.

    Parameters
    ----------
    outer_diameter, inner_diameter : diameters of the rod [m]

    Returns
    -------
    area [m^2]

    Notes
    -----
    Valid: d_i < d_o.

    References
    ----------
    [derived] area of a ring

    Examples
    --------
    >>> print(f"{section_area(outer_diameter=12e-3) * 1e6:.3f} mm^2")
    113.097 mm^2
    """
    return pi / 4 * (outer_diameter * outer_diameter - inner_diameter * inner_diameter)


@geometry
def second_moment(*, outer_diameter: Array, inner_diameter: Array = 0.0) -> Array:
    """Second moment of area of a round bar or tube.

    I = pi (d_o^4 - d_i^4)/64.

    Parameters
    ----------
    outer_diameter, inner_diameter : diameters of the rod [m]

    Returns
    -------
    second moment of area [m^4]

    Notes
    -----
    Valid: d_i < d_o.

    References
    ----------
    [derived] integral of y^2 over a ring

    Examples
    --------
    >>> print(f"{second_moment(outer_diameter=16e-3) * 1e12:.2f} mm^4")
    3216.99 mm^4
    """
    outer, inner = outer_diameter * outer_diameter, inner_diameter * inner_diameter
    return pi / 64 * (outer * outer - inner * inner)


@geometry
def axial_stiffness(
    *,
    youngs_modulus: Array,
    outer_diameter: Array,
    length: Array,
    inner_diameter: Array = 0.0,
) -> Array:
    """Axial stiffness of a solid or hollow rod.

    k = E A/L.

    Parameters
    ----------
    youngs_modulus : Young's modulus [Pa]
    outer_diameter, inner_diameter : diameters of the rod [m]
    length : length under load [m]

    Returns
    -------
    stiffness [N/m]

    Notes
    -----
    Valid: one homogeneous rod; a laminated one needs the EA of the layered tube.

    References
    ----------
    [ElAsswad2018] eq. 8, [AaltoThesis] eq. 21

    Examples
    --------
    >>> k = axial_stiffness(youngs_modulus=210e9, outer_diameter=25e-3, length=0.32)
    >>> print(f"{k / 1e6:.1f} kN/mm")
    322.1 kN/mm
    """
    area = section_area(outer_diameter=outer_diameter, inner_diameter=inner_diameter)
    return youngs_modulus * area / length


@geometry
def axial_stiffness_as_published(
    *, youngs_modulus: Array, outer_diameter: Array, length: Array
) -> Array:
    """Rod stiffness with the source's inputs: a solid section and a bending modulus.

    k = E pi d^2/(4 L). The published 13 430 N/mm means E/L = 118.75 N/mm^3 for a 12 mm rod: 13.1
    GPa with the table's stroke of 110 mm, 17.8 GPa with the 150 mm of the text.

    Parameters
    ----------
    youngs_modulus : modulus from a bending test [Pa]
    outer_diameter : rod diameter [m]
    length : rod length [m]

    Returns
    -------
    stiffness [N/m]

    Notes
    -----
    Valid: to reproduce the source; the formula is right, its inputs contradict each other.

    References
    ----------
    [ElAsswad2018] eq. 8 and table 1

    Examples
    --------
    >>> k = axial_stiffness_as_published(youngs_modulus=13.0625e9, outer_diameter=12e-3,
    ...                                  length=0.11)
    >>> print(f"{k / 1e3:.0f} N/mm")
    13430 N/mm
    """
    return youngs_modulus * section_area(outer_diameter=outer_diameter) / length


@geometry
def rod_stress(*, force: Array, outer_diameter: Array, inner_diameter: Array = 0.0) -> Array:
    """Axial stress of the rod.

    sigma = F/A.

    Parameters
    ----------
    force : axial force, tension positive [N]
    outer_diameter, inner_diameter : diameters of the rod [m]

    Returns
    -------
    stress [Pa], with the sign of the force

    Notes
    -----
    Valid: away from threads, shoulders and holes.

    References
    ----------
    [derived] force over area

    Examples
    --------
    >>> print(f"{rod_stress(force=10e3, outer_diameter=12e-3) / 1e6:.2f} MPa")
    88.42 MPa
    """
    return force / section_area(outer_diameter=outer_diameter, inner_diameter=inner_diameter)


@geometry
def bending_stress(
    *, bending_moment: Array, outer_diameter: Array, inner_diameter: Array = 0.0
) -> Array:
    """Largest bending stress of a round bar or tube.

    sigma = M d_o/(2 I).

    Parameters
    ----------
    bending_moment : M [N m]
    outer_diameter, inner_diameter : diameters of the rod [m]

    Returns
    -------
    stress [Pa]

    Notes
    -----
    Valid: linear elastic, slender.

    References
    ----------
    [derived] linear stress over the section of a beam

    Examples
    --------
    >>> print(f"{bending_stress(bending_moment=20.0, outer_diameter=16e-3) / 1e6:.2f} MPa")
    49.74 MPa
    """
    moment = second_moment(outer_diameter=outer_diameter, inner_diameter=inner_diameter)
    return bending_moment * outer_diameter / (2 * moment)


def free_modulus(*, wall: Sequence[Array]) -> Array:
    """Axial modulus of a layer that is free to contract.

    E_z = Czz - (Czt^2 Crr - 2 Czt Czr Ctr + Czr^2 Ctt)/(Ctt Crr - Ctr^2).

    Parameters
    ----------
    wall : stiffnesses zz, zt, zr, tt, tr, rr, ... in tube axes, from `solid_ply.solid_rotated` [Pa]

    Returns
    -------
    modulus [Pa]

    Notes
    -----
    Valid: layers of balanced pairs.

    References
    ----------
    [derived] free contraction by Schur complement of the layer's stiffness

    Examples
    --------
    >>> steel = (282.7e9, 121.2e9, 121.2e9, 282.7e9, 121.2e9, 282.7e9, 80.77e9)
    >>> print(f"{free_modulus(wall=steel) / 1e9:.1f} GPa")
    210.0 GPa
    """
    zz, zt, zr, tt, tr, rr = wall[:6]
    held = (zt * zt * rr - 2 * zt * zr * tr + zr * zr * tt) / (tt * rr - tr * tr)
    return zz - held


@geometry
def layered_section(
    *, walls: Sequence[Sequence[Any]], thicknesses: Sequence[Array], inner_diameter: Array
) -> tuple[Array, Array]:
    """Bending stiffness EI of a layered tube, and its shear stiffness GA without shear coefficient.

    EI = sum E_z I, GA = sum Css A; E_z = Czz - (Czt^2 Crr - 2 Czt Czr Ctr + Czr^2 Ctt)/
    (Ctt Crr - Ctr^2), with each layer free to contract. GA times `column.cowper_tube` is kappa G A.

    Parameters
    ----------
    walls : stiffnesses zz, zt, zr, tt, tr, rr, ..., ss of each layer from the bore, in tube axes,
        from `solid_ply.solid_rotated` [Pa]
    thicknesses : thickness of each layer [m]
    inner_diameter : bore of the tube [m]

    Returns
    -------
    EI [N m^2], GA [N]

    Notes
    -----
    Valid: layers of balanced pairs; about 1 % low, as sum E_z A is 1 % below EA of the exact tube.

    References
    ----------
    [derived] plane sections; free contraction by Schur complement of the layer's stiffness

    Examples
    --------
    >>> steel = (282.7e9, 121.2e9, 121.2e9, 282.7e9, 121.2e9, 282.7e9, 80.77e9)
    >>> bending, shear = layered_section(walls=[steel], thicknesses=[2e-3], inner_diameter=12e-3)
    >>> print(f"{bending:.1f} N m^2, {shear / 1e6:.3f} MN")
    461.7 N m^2, 7.105 MN
    """
    bending: Array = 0.0
    shear: Array = 0.0
    bore = inner_diameter
    for wall, thickness in zip(walls, thicknesses, strict=True):
        face = bore + 2 * thickness
        size = {"outer_diameter": face, "inner_diameter": bore}
        bending = bending + free_modulus(wall=wall) * second_moment(**size)
        shear = shear + wall[-1] * section_area(**size)
        bore = face
    return bending, shear


@geometry
def thread_stress_area(*, diameter: Array, pitch: Array) -> Array:
    """Tensile stress area of a metric thread.

    A_s = pi/4 (d - 0.9382 P)^2.

    Parameters
    ----------
    diameter : nominal diameter [m]
    pitch : pitch [m]

    Returns
    -------
    stress area [m^2]

    Notes
    -----
    Valid: ISO 60 degree threads.

    References
    ----------
    [ISO898-1] nominal stress area

    Examples
    --------
    >>> print(f"{thread_stress_area(diameter=10e-3, pitch=1.5e-3) * 1e6:.2f} mm^2")
    57.99 mm^2
    """
    core = diameter - 0.9382 * pitch
    return pi / 4 * core * core


@geometry
def thread_stress(*, force: Array, diameter: Array, pitch: Array) -> Array:
    """Tensile stress in a metric thread.

    sigma = F/A_s.

    Parameters
    ----------
    force : axial force [N]
    diameter : nominal diameter [m]
    pitch : pitch [m]

    Returns
    -------
    stress [Pa]

    Notes
    -----
    Valid: ISO 60 degree threads; nominal, without the notch of the root.

    References
    ----------
    [ISO898-1] nominal stress area

    Examples
    --------
    >>> print(f"{thread_stress(force=10e3, diameter=10e-3, pitch=1.5e-3) / 1e6:.2f} MPa")
    172.45 MPa
    """
    return force / thread_stress_area(diameter=diameter, pitch=pitch)
