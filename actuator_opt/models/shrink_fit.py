"""A metal ring shrunk over a layered tube: contact pressure, grip by friction, limits of the ring.

The tube is that of `layered_tube`. Its outside grows by u_t, under bore pressure, axial force and
temperature; the bore of the ring grows by u_r with temperature. An outer pressure of 1 Pa moves the
tube's outside inwards by C_t, and an inner pressure of 1 Pa widens the ring by C_r.
"""

from __future__ import annotations

from math import pi

from ..base.numeric import Array, geometry, namespace
from .barrel import von_mises
from .layered_tube import LayeredTube, tube_state, tube_stresses


def outer_growth(
    *,
    tube: LayeredTube,
    inner_pressure: Array = 0.0,
    outer_pressure: Array = 0.0,
    axial_force: Array = 0.0,
    temperature_change: Array = 0.0,
) -> Array:
    """Growth of the radius of a layered tube's outside, e_t r_o, from the exact tube.

    Parameters
    ----------
    tube : from `layered_tube`
    inner_pressure, outer_pressure : gauge pressures [Pa]
    axial_force : in the wall [N]
    temperature_change : [K]

    Returns
    -------
    growth [m]; under an outer pressure of 1 Pa alone, it is -C_t

    Notes
    -----
    Valid: as `layered_tube.tube_state`, far from the ends of ring and tube.

    References
    ----------
    [Lekhnitskii1963] generalised plane strain

    Examples
    --------
    >>> from .layered_tube import TubeLayer, layered_tube
    >>> steel = (282.7e9, 121.2e9, 121.2e9, 282.7e9, 121.2e9, 282.7e9, 80.8e9)
    >>> tube = layered_tube(layers=[TubeLayer(stiffness=steel, thickness=4e-3)],
    ...                     inner_radius=16e-3)
    >>> print(f"{outer_growth(tube=tube, inner_pressure=28e6) * 1e6:.3f}")
    9.483
    """
    state = tube_state(
        tube=tube,
        inner_pressure=inner_pressure,
        outer_pressure=outer_pressure,
        axial_force=axial_force,
        temperature_change=temperature_change,
    )
    return state.hoop_strain[1, -1, ...] * state.radius[1, -1, ...]


def bore_stress(*, tube: LayeredTube) -> Array:
    """Von Mises stress of a metal at the bore of a layered tube, per unit outer pressure.

    Parameters
    ----------
    tube : from `layered_tube`, its innermost layer isotropic

    Returns
    -------
    stress divided by pressure [-]

    Notes
    -----
    Valid: as `layered_tube.tube_state`; no bore pressure, no axial force.

    References
    ----------
    [Lekhnitskii1963] generalised plane strain; [Timoshenko1970] distortion energy

    Examples
    --------
    >>> from .layered_tube import TubeLayer, layered_tube
    >>> steel = (282.7e9, 121.2e9, 121.2e9, 282.7e9, 121.2e9, 282.7e9, 80.8e9)
    >>> tube = layered_tube(layers=[TubeLayer(stiffness=steel, thickness=4e-3)],
    ...                     inner_radius=16e-3)
    >>> print(f"{bore_stress(tube=tube):.4f}")
    5.5556
    """
    state = tube_state(tube=tube, outer_pressure=1.0)
    axial, hoop, radial, _ = tube_stresses(tube=tube, state=state)
    return von_mises(hoop=hoop[0, 0, ...], radial=radial[0, 0, ...], axial=axial[0, 0, ...])


@geometry
def ring_give(
    *, inner_radius: Array, wall_thickness: Array, youngs_modulus: Array, poissons_ratio: Array
) -> Array:
    """Growth of a ring's bore per unit pressure in it, r/E ((b^2 + r^2)/(b^2 - r^2) + nu).

    Parameters
    ----------
    inner_radius : r [m]
    wall_thickness : b - r [m]
    youngs_modulus : E [Pa]
    poissons_ratio : nu [-]

    Returns
    -------
    C_r [m/Pa]

    Notes
    -----
    Valid: elastic ring without axial force.

    References
    ----------
    [Timoshenko1970] Lame's thick ring

    Examples
    --------
    >>> c = ring_give(inner_radius=15.2e-3, wall_thickness=2e-3, youngs_modulus=210e9,
    ...               poissons_ratio=0.3)
    >>> print(f"{c * 1e15:.4f} nm/MPa")
    610.2340 nm/MPa
    """
    return inner_radius / youngs_modulus * (_ratio(inner_radius, wall_thickness) + poissons_ratio)


def _ratio(inner_radius: Array, wall: Array) -> Array:
    """Hoop stress at a ring's bore per unit pressure there, (b^2 + r^2)/(b^2 - r^2)."""
    outer = inner_radius + wall
    squares = inner_radius * inner_radius, outer * outer
    return (squares[1] + squares[0]) / (squares[1] - squares[0])


def contact_pressure(
    *, interference: Array, tube_growth: Array, ring_growth: Array, tube_give: Array, give: Array
) -> Array:
    """Pressure between ring and tube, p_c = (delta + u_t - u_r)/(C_t + C_r).

    Parameters
    ----------
    interference : delta, of the radii [m]
    tube_growth : u_t [m]
    ring_growth : u_r [m]
    tube_give : C_t [m/Pa]
    give : C_r of the ring [m/Pa]

    Returns
    -------
    pressure; negative where ring and tube part [Pa]

    Notes
    -----
    Valid: elastic, far from the ring's edges.

    References
    ----------
    [Timoshenko1970] shrink fit

    Examples
    --------
    >>> p = contact_pressure(interference=20e-6, tube_growth=5.02568e-6, ring_growth=0.0,
    ...                      tube_give=5.58550e-13, give=6.10234e-13)
    >>> print(f"{p / 1e6:.4f}")
    21.4117
    """
    return (interference + tube_growth - ring_growth) / (tube_give + give)


@geometry
def grip(*, friction_coefficient: Array, radius: Array, pressure: Array, length: Array) -> Array:
    """Axial force that friction holds, mu 2 pi r p_c L.

    Parameters
    ----------
    friction_coefficient : mu, of the dry contact, times its relaxation [-]
    radius : r of the contact [m]
    pressure : p_c [Pa]
    length : L, without the ends of the ring that count as free [m]

    Returns
    -------
    force [N]

    Notes
    -----
    Valid: constant pressure.

    References
    ----------
    [Shigley2011] holding force of an interference fit

    Examples
    --------
    >>> f = grip(friction_coefficient=0.12, radius=15.2e-3, pressure=17.1118e6, length=15e-3)
    >>> print(f"{f:.2f}")
    2941.65
    """
    return friction_coefficient * 2 * pi * radius * pressure * length


@geometry
def ring_stress(*, inner_radius: Array, wall_thickness: Array) -> Array:
    """Von Mises stress at a ring's bore per unit pressure there.

    Parameters
    ----------
    inner_radius : r [m]
    wall_thickness : thickness of the ring [m]

    Returns
    -------
    stress divided by pressure [-]

    Notes
    -----
    Valid: elastic ring without axial force.

    References
    ----------
    [Timoshenko1970] Lame's thick ring

    Examples
    --------
    >>> print(f"{ring_stress(inner_radius=15.2e-3, wall_thickness=2e-3):.5f}")
    8.67420
    """
    return von_mises(hoop=_ratio(inner_radius, wall_thickness), radial=-1.0, axial=0.0)


@geometry
def plastic_pressure(*, inner_radius: Array, wall_thickness: Array, yield_strength: Array) -> Array:
    """Pressure at which the whole ring flows, as when it is crimped: (2/sqrt(3)) R_e ln(b/r).

    Parameters
    ----------
    inner_radius : r [m]
    wall_thickness : b - r [m]
    yield_strength : R_e [Pa]

    Returns
    -------
    pressure [Pa]

    Notes
    -----
    Valid: plane strain, no hardening.

    References
    ----------
    [Hill1950] thick tube, fully plastic

    Examples
    --------
    >>> p = plastic_pressure(inner_radius=15.2e-3, wall_thickness=2e-3, yield_strength=355e6)
    >>> print(f"{p / 1e6:.4f}")
    50.6717
    """
    xp = namespace(inner_radius, wall_thickness)
    return 2 / 3**0.5 * yield_strength * xp.log((inner_radius + wall_thickness) / inner_radius)


@geometry
def collapse_pressure(*, hoop_bending_stiffness: Array, radius: Array) -> Array:
    """Outer pressure that buckles a long tube inwards, 3 D/R^3.

    Parameters
    ----------
    hoop_bending_stiffness : D of the wall in the hoop direction, per length [N m]
    radius : R, of the middle [m]

    Returns
    -------
    pressure [Pa]

    Notes
    -----
    Valid: long thin tube; a short length that a ring presses holds more.

    References
    ----------
    [TimoshenkoGere1961] long tube under outer pressure

    Examples
    --------
    >>> print(f"{collapse_pressure(hoop_bending_stiffness=60.0, radius=12e-3) / 1e6:.2f}")
    104.17
    """
    return 3 * hoop_bending_stiffness / (radius * radius * radius)
