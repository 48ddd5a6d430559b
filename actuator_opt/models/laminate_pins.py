"""Radial pins that hold a plug in the end of a laminated tube: stresses, strengths, load sharing.

The pins go through the laminate into the plug, in one row or two. F is the axial force of the end,
n the number of pins per row and d their diameter, t the thickness of the laminate and R its middle
radius. Stresses are mean stresses, apart from those at holes.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import pi

from ..base.dataclass import dataclass
from ..base.numeric import Array, absolute, geometry, maximum, minimum, namespace, real, sqrt, where
from . import laminate, ply

QUASI_ISOTROPIC = 0.27
"""Share of an elastic stress concentration that a laminate keeps at failure [HartSmith1978]."""

FATIGUE_SHARE, FATIGUE_CYCLES = 0.25, 1e6
"""Bearing strength in fatigue, as a share of the static one, at this number of cycles. Published
shares are 0.25 to 0.4 [Akay1995]; the lower one is our choice."""


@dataclass(frozen=True, slots=True)
class FibreLayer:
    """A layer of the laminate, a balanced +-angle pair.

    `stiffness` is from `ply.ply_stiffness` [Pa], `angle` is measured from the tube axis [rad], and
    `tension` and `compression` are the strengths along the fibre [Pa].
    """

    thickness: Array
    angle: Array
    stiffness: ply.Stiffness
    tension: Array
    compression: Array


@geometry
def bearing_stress(*, force: Array, count: Array, diameter: Array, thickness: Array) -> Array:
    """Mean stress between the pins of a row and their holes, F/(n d t).

    Parameters
    ----------
    force : F of the row [N]
    count : n [-]
    diameter : d [m]
    thickness : t of the laminate, or depth of the holes in the plug [m]

    Returns
    -------
    stress [Pa]

    Notes
    -----
    Valid: t/d from 0.5 to 1 in a laminate.

    References
    ----------
    [HartSmith1978] bearing stress

    Examples
    --------
    >>> s = bearing_stress(force=7273.57, count=12, diameter=4e-3, thickness=3e-3)
    >>> print(f"{s / 1e6:.4f}")
    50.5109
    """
    return force / (count * diameter * thickness)


@geometry
def shear_out_stress(
    *, force: Array, count: Array, thickness: Array, edge_distance: Array
) -> Array:
    """Mean shear stress of the two planes from a hole to the laminate's end, F/(2 n t e).

    Parameters
    ----------
    force : F of the row [N]
    count : n [-]
    thickness : t [m]
    edge_distance : e, from the centre of the hole to the end of the laminate [m]

    Returns
    -------
    stress [Pa]

    Notes
    -----
    Valid: e at least 3 d, with +-45 plies.

    References
    ----------
    [HartSmith1978] shear-out stress

    Examples
    --------
    >>> s = shear_out_stress(force=7273.57, count=12, thickness=3e-3, edge_distance=12e-3)
    >>> print(f"{s / 1e6:.5f}")
    8.41848
    """
    return force / (2 * count * thickness * edge_distance)


@geometry
def net_section_stress(
    *, force: Array, count: Array, diameter: Array, thickness: Array, radius: Array
) -> Array:
    """Mean axial stress of the laminate between the holes of a row, F/((2 pi R - n d) t).

    Parameters
    ----------
    force : F of the whole end [N]
    count : n [-]
    diameter : d [m]
    thickness : t [m]
    radius : R [m]

    Returns
    -------
    stress [Pa]

    Notes
    -----
    Valid: n d below the circumference; `elastic_hole_factor` gives the peak.

    References
    ----------
    [HartSmith1978] net section

    Examples
    --------
    >>> s = net_section_stress(force=7273.57, count=12, diameter=4e-3, thickness=3e-3, radius=14e-3)
    >>> print(f"{s / 1e6:.4f}")
    60.6668
    """
    return force / ((2 * pi * radius - count * diameter) * thickness)


@geometry
def elastic_hole_factor(*, diameter: Array, pitch: Array, edge_distance: Array) -> Array:
    """Peak stress of an isotropic sheet at a pin-loaded hole, divided by that of its net section.

    k_te = 2 + (w/d - 1) - 1.5 T (w/d - 1)/(w/d + 1), T = 1.5 - 0.5 w/e for e below w, else 1.

    Parameters
    ----------
    diameter : d [m]
    pitch : w, circumference per pin [m]
    edge_distance : e [m]

    Returns
    -------
    k_te [-]

    Notes
    -----
    Valid: w/d above 1.

    References
    ----------
    [HartSmith1978] fit to elastic solutions

    Examples
    --------
    >>> print(f"{elastic_hole_factor(diameter=4e-3, pitch=7.330383e-3, edge_distance=12e-3):.5f}")
    2.39169
    """
    wide = pitch / diameter
    close = where(
        real(edge_distance) < real(pitch),
        1.5 - 0.5 * pitch / edge_distance,
        1.0 + 0 * edge_distance,
    )
    return 1 + wide - 1.5 * close * (wide - 1) / (wide + 1)


def laminate_hole_factor(*, elastic_factor: Array) -> Array:
    """Stress concentration of a quasi-isotropic laminate at failure, 1 + 0.27 (k_te - 1).

    Parameters
    ----------
    elastic_factor : k_te from `elastic_hole_factor` [-]

    Returns
    -------
    k_tc [-]

    Notes
    -----
    Valid: quasi-isotropic carbon/epoxy.

    References
    ----------
    [HartSmith1978] softening of the concentration before failure

    Examples
    --------
    >>> print(f"{laminate_hole_factor(elastic_factor=2.39169):.5f}")
    1.37576
    """
    return 1 + QUASI_ISOTROPIC * (elastic_factor - 1)


@geometry
def pin_shear(*, force: Array, count: Array, diameter: Array) -> Array:
    """Mean shear stress of the pins of a row in single shear, 4 F/(n pi d^2).

    Parameters
    ----------
    force : F of the row [N]
    count : n [-]
    diameter : d [m]

    Returns
    -------
    stress [Pa]

    Notes
    -----
    Valid: solid pins.

    References
    ----------
    [derived] force over the sections

    Examples
    --------
    >>> print(f"{pin_shear(force=7273.57, count=12, diameter=4e-3) / 1e6:.4f}")
    48.2344
    """
    return 4 * force / (count * pi * diameter * diameter)


@geometry
def pin_bending(*, force: Array, count: Array, diameter: Array, lever_length: Array) -> Array:
    """Elastic bending stress of the pins of a row at the plug's surface, 32 F a/(n pi d^3).

    Parameters
    ----------
    force : F of the row [N]
    count : n [-]
    diameter : d [m]
    lever_length : a, from the plug's surface to the resultant in the laminate; half of t without
        a gap [m]

    Returns
    -------
    stress [Pa]

    Notes
    -----
    Valid: pins held upright by the plug only. A head would share the moment, so this is the most.

    References
    ----------
    [derived] cantilever of round section

    Examples
    --------
    >>> s = pin_bending(force=7273.57, count=12, diameter=4e-3, lever_length=1.5e-3)
    >>> print(f"{s / 1e6:.3f}")
    144.703
    """
    return 32 * force * lever_length / (count * pi * diameter * diameter * diameter)


@geometry
def plastic_pin_bending(
    *, force: Array, count: Array, diameter: Array, lever_length: Array
) -> Array:
    """Strength that the pins of a row need against a plastic hinge, 6 F a/(n d^3).

    Parameters
    ----------
    force : F of the row [N]
    count : n [-]
    diameter : d [m]
    lever_length : a, as in `pin_bending` [m]

    Returns
    -------
    stress [Pa]

    Notes
    -----
    Valid: as `pin_bending`, ductile pins.

    References
    ----------
    [derived] plastic section modulus d^3/6 of a circle

    Examples
    --------
    >>> s = plastic_pin_bending(force=7273.57, count=12, diameter=4e-3, lever_length=1.5e-3)
    >>> print(f"{s / 1e6:.4f}")
    85.2371
    """
    return 6 * force * lever_length / (count * diameter * diameter * diameter)


@geometry
def holding_depth(*, depth: Array, lever_length: Array) -> Array:
    """Depth of plug that resists the force of a pin, if the plug also keeps the pin upright.

    The plug presses on the pin with its full strength: one way near the surface, the other way near
    the pin's end. Equilibrium of force and moment gives y = sqrt((w + 2 a)^2 + w^2) - (w + 2 a).

    Parameters
    ----------
    depth : w, depth of the pin in the plug [m]
    lever_length : a, as in `pin_bending` [m]

    Returns
    -------
    y; the force that the plug holds is its strength times d y [m]

    Notes
    -----
    Valid: plastic plug, stiff pin; without lever, y is 0.414 w.

    References
    ----------
    [Johansen1949] rotation of a stiff dowel; [derived] for a lever

    Examples
    --------
    >>> print(f"{holding_depth(depth=3e-3, lever_length=1.5e-3) * 1e3:.5f}")
    0.70820
    """
    arm = depth + 2 * lever_length
    return sqrt(arm * arm + depth * depth) - arm


@geometry
def pin_flexibility(
    *,
    diameter: Array,
    thickness: Array,
    modulus: Array,
    depth: Array,
    plug_modulus: Array,
    pin_modulus: Array,
) -> Array:
    """Slip between laminate and plug at one pin, per force on it.

    C = 4.2 ((t + w)/(2 d))^(2/3) (1/(t E) + 1/(w E_s) + 1/(2 t E_p) + 1/(2 w E_p)).

    Parameters
    ----------
    diameter : d [m]
    thickness : t of the laminate [m]
    modulus : E, axial, of the laminate [Pa]
    depth : w, depth of the pin in the plug [m]
    plug_modulus : E_s [Pa]
    pin_modulus : E_p [Pa]

    Returns
    -------
    flexibility [m/N]

    Notes
    -----
    Valid: single shear, bolts in carbon/epoxy; a fit to tests of flat laps.

    References
    ----------
    [Huth1986] fastener flexibility, exponent 2/3 and factor 4.2

    Examples
    --------
    >>> c = pin_flexibility(diameter=4e-3, thickness=3e-3, modulus=5e10, depth=4e-3,
    ...                     plug_modulus=71.7e9, pin_modulus=205e9)
    >>> print(f"{c * 1e9:.4f} um/kN")
    44.4788 um/kN
    """
    slender = (thickness + depth) / (2 * diameter)
    xp = namespace(slender)
    give = (1 / modulus + 1 / (2 * pin_modulus)) / thickness
    give = give + (1 / plug_modulus + 1 / (2 * pin_modulus)) / depth
    return 4.2 * xp.exp(2 / 3 * xp.log(slender)) * give


@geometry
def first_row_share(
    *,
    row_stiffness: Array,
    tube_give: Array,
    sleeve_give: Array,
    loaded_together: bool,
) -> Array:
    """Share of the force that the first of two rows of pins takes.

    (1/k + g_t)/(2/k + g_t + g_s) if tube and sleeve leave the joint at opposite ends, as in a lap;
    (1/k + g_t + g_s)/(2/k + g_t + g_s) if both leave it at the first row, as for a plug.

    Parameters
    ----------
    row_stiffness : k of one row, n/C [N/m]
    tube_give, sleeve_give : g = s/(E A) of tube and sleeve between the rows, a length s apart [m/N]
    loaded_together : whether both are loaded at the first row

    Returns
    -------
    share of the first row [-]

    Notes
    -----
    Valid: equal rows, elastic; holes without play.

    References
    ----------
    [derived] equal give of both ways through the joint

    Examples
    --------
    >>> give = {"row_stiffness": 2e8, "tube_give": 1e-9, "sleeve_give": 2e-9}
    >>> for together in (False, True):
    ...     print(f"{first_row_share(**give, loaded_together=together):.4f}")
    0.4615
    0.6154
    """
    first = 1 / row_stiffness + tube_give + (sleeve_give if loaded_together else 0.0)
    return first / (2 / row_stiffness + tube_give + sleeve_give)


def _membrane(layers: Sequence[FibreLayer]) -> tuple[laminate.Membrane, Array, Array]:
    """Membrane stiffness and shear stiffness [N/m], and thickness of the laminate [m]."""
    rotated = [ply.rotated(stiffness=layer.stiffness, angle=layer.angle) for layer in layers]
    thicknesses = [layer.thickness for layer in layers]
    shear = sum(q[5] * layer.thickness for q, layer in zip(rotated, layers, strict=True))
    return laminate.membrane(plies=rotated, thicknesses=thicknesses), shear, sum(thicknesses)


def axial_modulus(*, layers: Sequence[FibreLayer]) -> Array:
    """Axial modulus of a laminate that is free to contract, (A_zz - A_zt^2/A_tt)/t.

    Parameters
    ----------
    layers : its layers

    Returns
    -------
    modulus [Pa]

    Notes
    -----
    Valid: balanced layers.

    References
    ----------
    [Jones1999] laminate moduli

    Examples
    --------
    >>> q = ply.ply_stiffness(youngs_modulus_1=135e9, youngs_modulus_2=8.5e9,
    ...                       poissons_ratio_12=0.3, shear_modulus_12=4.3e9)
    >>> plies = [FibreLayer(t, a, q, 1e9, 1e9) for t, a in ((1e-3, 0.0), (2e-3, pi / 4),
    ...                                                     (1e-3, pi / 2))]
    >>> print(f"{axial_modulus(layers=plies) / 1e9:.3f}")
    51.335
    """
    stiffness, _, thickness = _membrane(layers)
    return laminate.effective_moduli(membrane=stiffness, thickness=thickness)[0]


@geometry
def fibre_strengths(*, layers: Sequence[FibreLayer]) -> tuple[Array, Array]:
    """Mean axial stress and mean shear stress of a laminate at which the first fibres fail.

    The strains of the whole laminate give the stress along the fibres of each layer; matrix cracks
    are allowed. Shear pulls one half of a balanced pair and presses the other.

    Parameters
    ----------
    layers : its layers

    Returns
    -------
    axial tensile strength and shear strength [Pa]

    Notes
    -----
    Valid: fibres in at least three directions, so that fibres carry both loads.

    References
    ----------
    [Jones1999] laminate strains; [derived] failure of fibres

    Examples
    --------
    >>> q = ply.ply_stiffness(youngs_modulus_1=135e9, youngs_modulus_2=8.5e9,
    ...                       poissons_ratio_12=0.3, shear_modulus_12=4.3e9)
    >>> plies = [FibreLayer(t, a, q, 1e9, 1e9) for t, a in ((1e-3, 0.0), (2e-3, pi / 4),
    ...                                                     (1e-3, pi / 2))]
    >>> print(*(f"{s / 1e6:.2f}" for s in fibre_strengths(layers=plies)))
    380.35 293.51
    """
    stiffness, shear, thickness = _membrane(layers)
    axial, hoop = laminate.strains(
        membrane=stiffness, axial_line_force=thickness, hoop_line_force=0.0
    )
    slip = thickness / shear
    pulled: Array = 0.0
    sheared: Array = 0.0
    for layer in layers:
        q11, q12, *_ = layer.stiffness
        stress, *_ = ply.ply_stresses(
            stiffness=layer.stiffness, angle=layer.angle, axial_strain=axial, hoop_strain=hoop
        )
        pulled = maximum(pulled, maximum(stress / layer.tension, -stress / layer.compression))
        turned = namespace(layer.angle, slip).sin(2 * layer.angle) / 2
        weak = minimum(layer.tension, layer.compression)
        sheared = maximum(sheared, absolute((q11 - q12) * turned * slip) / weak)
    return 1 / pulled, 1 / sheared


def bearing_cycles(*, share: Array) -> Array:
    """Cycles of a pulsating bearing stress until the holes are worn, log10 N = 6 (1 - s)/0.75.

    A straight line over log N, from the static strength to a quarter of it at 10^6 cycles.

    Parameters
    ----------
    share : s, bearing stress divided by static bearing strength [-]

    Returns
    -------
    cycles [-]

    Notes
    -----
    Valid: carbon/epoxy; no data of the library's plies.

    References
    ----------
    [Akay1995] a quarter of the static strength at 10^6 cycles

    Examples
    --------
    >>> print(f"{bearing_cycles(share=0.25):.0f} {bearing_cycles(share=1.0):.0f}")
    1000000 1
    """
    xp = namespace(share)
    return xp.exp(xp.log(share * 0 + FATIGUE_CYCLES) * (1 - share) / (1 - FATIGUE_SHARE))
