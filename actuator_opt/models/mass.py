"""Masses and volumes of parts, in closed forms that can be checked by hand.

Masses are density times volume; `oil_mass` is reported apart from the dry mass.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from ..base.numeric import Array, absolute, geometry


@geometry
def tube_mass(
    *, density: Array, inner_diameter: Array, outer_diameter: Array, length: Array
) -> Array:
    """Mass of a tube, rod (inner diameter 0) or ring, rho pi (Do^2 - Di^2) L/4.

    Parameters
    ----------
    density : [kg/m^3]
    inner_diameter, outer_diameter, length : [m]

    Returns
    -------
    mass [kg]

    Notes
    -----
    Valid: Do >= Di.

    References
    ----------
    [derived] volume of a hollow cylinder

    Examples
    --------
    >>> m = tube_mass(density=7850.0, inner_diameter=0.0, outer_diameter=12e-3, length=0.15)
    >>> print(f"{m * 1e3:.1f} g")
    133.2 g
    """
    ring = outer_diameter * outer_diameter - inner_diameter * inner_diameter
    return (0.25 * math.pi) * density * ring * length


@geometry
def layer_area(*, inner_radius: Array, thickness: Array) -> Array:
    """Cross-section of a layer of a tube, pi t (2 r + t), exact to rounding for thin layers too.

    Parameters
    ----------
    inner_radius, thickness : of the layer [m]

    Returns
    -------
    area [m^2]

    Notes
    -----
    Valid: everywhere.

    References
    ----------
    [derived] area of a ring

    Examples
    --------
    >>> print(f"{layer_area(inner_radius=10e-3, thickness=2e-3) * 1e6:.2f} mm^2")
    138.23 mm^2
    """
    return math.pi * (thickness * (2 * inner_radius + thickness))


def turned_volume(*, profile: Sequence[tuple[Array, Array]]) -> Array:
    """Volume of a polygon turned about the axis, |(pi/3) sum (x_2 - x_1)(r_1^2 + r_1 r_2 + r_2^2)|.

    Parameters
    ----------
    profile : corners (axial position x, radius r) in order [m]

    Returns
    -------
    volume [m^3]

    Notes
    -----
    Valid: edges that do not cross, r >= 0.

    References
    ----------
    [derived] sum of frustums of cones

    Examples
    --------
    >>> cone = [(0.0, 0.0), (0.3, 0.0), (0.3, 0.1)]
    >>> print(f"{turned_volume(profile=cone) * 1e3:.5f} l")
    3.14159 l
    """
    total: Array = 0.0
    for (x1, r1), (x2, r2) in zip(profile, [*profile[1:], profile[0]], strict=True):
        total = total + (x2 - x1) * (r1 * r1 + r1 * r2 + r2 * r2)
    return absolute((math.pi / 3) * total)


@geometry
def tapered_ring_volume(
    *,
    inner_radius: Array,
    tip_radius: Array,
    outer_radius: Array,
    length: Array,
    taper_length: Array,
) -> Array:
    """Volume of a ring whose outside is a cone at one end.

    V = pi [(b^2 - r^2)(L - T) + ((a^2 + a b + b^2)/3 - r^2) T].

    Parameters
    ----------
    inner_radius, tip_radius, outer_radius : r, a at the tip and b [m]
    length, taper_length : L, and T of the cone [m]

    Returns
    -------
    volume [m^3]

    Notes
    -----
    Valid: 0 <= T <= L.

    References
    ----------
    [derived] ring and frustum of a cone

    Examples
    --------
    >>> volume = tapered_ring_volume(inner_radius=10e-3, tip_radius=11e-3, outer_radius=12e-3,
    ...                              length=20e-3, taper_length=5e-3)
    >>> print(f"{1e9 * volume:.1f}")
    2581.3
    """
    a, b, inner = tip_radius, outer_radius, inner_radius * inner_radius
    cone = (a * a + a * b + b * b) / 3 - inner
    return math.pi * ((b * b - inner) * (length - taper_length) + cone * taper_length)


@geometry
def disc_mass(*, density: Array, diameter: Array, thickness: Array) -> Array:
    """Mass of a solid disc (piston, cap), rho pi D^2 t/4.

    Parameters
    ----------
    density : [kg/m^3]
    diameter, thickness : [m]

    Returns
    -------
    mass [kg]

    Notes
    -----
    Valid: everywhere.

    References
    ----------
    [derived] volume of a cylinder

    Examples
    --------
    >>> print(f"{disc_mass(density=2700.0, diameter=30e-3, thickness=8e-3) * 1e3:.2f} g")
    15.27 g
    """
    return (0.25 * math.pi) * density * diameter * diameter * thickness


@geometry
def piston_groove_volume(*, diameter: Array, depth: Array, width: Array) -> Array:
    """Material removed by an outer groove (piston), pi w h (D - h).

    Parameters
    ----------
    diameter : outer diameter the groove is cut into [m]
    depth : radial [m]
    width : axial [m]

    Returns
    -------
    volume [m^3]

    Notes
    -----
    Valid: depth < diameter/2.

    References
    ----------
    [derived] pi/4 (D^2 - (D - 2h)^2) w

    Examples
    --------
    >>> v = piston_groove_volume(diameter=25e-3, depth=1.7e-3, width=2.4e-3)
    >>> print(f"{v * 1e9:.1f} mm3")
    298.7 mm3
    """
    return math.pi * width * depth * (diameter - depth)


@geometry
def rod_groove_volume(*, diameter: Array, depth: Array, width: Array) -> Array:
    """Material removed by an inner groove (rod seal in the head), pi w h (d + h).

    Parameters
    ----------
    diameter : hole diameter the groove is cut into [m]
    depth : radial [m]
    width : axial [m]

    Returns
    -------
    volume [m^3]

    Notes
    -----
    Valid: everywhere.

    References
    ----------
    [derived] pi/4 ((d + 2h)^2 - d^2) w

    Examples
    --------
    >>> v = rod_groove_volume(diameter=12e-3, depth=1.7e-3, width=2.4e-3)
    >>> print(f"{v * 1e9:.1f} mm3")
    175.6 mm3
    """
    return math.pi * width * depth * (diameter + depth)


@geometry
def pitch_diameter(*, diameter: Array, pitch: Array) -> Array:
    """Pitch diameter of a metric thread, d2 = d - (3 sqrt(3)/8) P.

    Parameters
    ----------
    diameter : nominal [m]
    pitch : [m]

    Returns
    -------
    pitch diameter [m]

    Notes
    -----
    Valid: ISO metric profile.

    References
    ----------
    [ISO724] basic dimensions

    Examples
    --------
    >>> print(f"{pitch_diameter(diameter=10e-3, pitch=1.5e-3) * 1e3:.3f} mm")
    9.026 mm
    """
    return diameter - (3 * math.sqrt(3) / 8) * pitch


@geometry
def stud_mass(*, density: Array, diameter: Array, pitch: Array, length: Array) -> Array:
    """Mass of a threaded stud, the cylinder of its pitch diameter.

    Ridges above and roots below the pitch line have equal section, so the pitch cylinder has the
    thread's volume, apart from its curvature and rounding (choice).

    Parameters
    ----------
    density : [kg/m^3]
    diameter, pitch, length : [m]

    Returns
    -------
    mass [kg]

    Notes
    -----
    Valid: ISO metric profile, full thread.

    References
    ----------
    [ISO724] pitch diameter; [derived] equal sections above and below the pitch line

    Examples
    --------
    >>> m = stud_mass(density=7850.0, diameter=10e-3, pitch=1.5e-3, length=20e-3)
    >>> print(f"{m * 1e3:.2f} g")
    10.05 g
    """
    return disc_mass(
        density=density, diameter=pitch_diameter(diameter=diameter, pitch=pitch), thickness=length
    )


@geometry
def tie_rod_mass(*, density: Array, diameter: Array, length: Array, count: Array) -> Array:
    """Mass of tie rods, n plain round bars of the nominal diameter, without nuts.

    Parameters
    ----------
    density : [kg/m^3]
    diameter, length : [m]
    count : [-]

    Returns
    -------
    mass [kg]

    Notes
    -----
    Valid: everywhere.

    References
    ----------
    [derived] volume of cylinders

    Examples
    --------
    >>> m = tie_rod_mass(density=7850.0, diameter=6e-3, length=0.2, count=4.0)
    >>> print(f"{m * 1e3:.1f} g")
    177.6 g
    """
    return count * disc_mass(density=density, diameter=diameter, thickness=length)


@geometry
def eye_volume(*, pin_diameter: Array) -> Array:
    """Volume of a clevis eye, pi d^3, in proportions of its pin diameter d.

    Choices: a round lug of outer radius d and thickness d with a hole d (3/4 pi d^3), and a
    round neck of diameter d and length d from the lug's rim (1/4 pi d^3). The crescent between
    rim and flat neck end (about pi d^3/128) and fillets are neglected.

    Parameters
    ----------
    pin_diameter : [m]

    Returns
    -------
    volume [m^3]

    Notes
    -----
    Valid: these proportions.

    References
    ----------
    [derived] disc minus hole plus cylinder

    Examples
    --------
    >>> print(f"{eye_volume(pin_diameter=8e-3) * 1e9:.1f} mm3")
    1608.5 mm3
    """
    return math.pi * pin_diameter * pin_diameter * pin_diameter


@geometry
def eye_length(*, pin_diameter: Array) -> Array:
    """Distance from the pin centre to the end of the eye's neck, 2 d (see `eye_volume`).

    Parameters
    ----------
    pin_diameter : [m]

    Returns
    -------
    length [m]

    Notes
    -----
    Valid: the proportions of `eye_volume`.

    References
    ----------
    [derived] lug radius d and neck length d

    Examples
    --------
    >>> eye_length(pin_diameter=8e-3)
    0.016
    """
    return 2 * pin_diameter


@geometry
def ring_mass(*, density: Array, area: Array, centre_diameter: Array) -> Array:
    """Mass of a ring of any section, rho A pi D_m; an O-ring has A = pi W^2/4.

    Parameters
    ----------
    density : [kg/m^3]
    area : of the section, A [m^2]
    centre_diameter : diameter through the centroid of the section, D_m [m]

    Returns
    -------
    mass [kg]

    Notes
    -----
    Valid: the section does not reach the axis.

    References
    ----------
    [derived] Pappus' theorem

    Examples
    --------
    >>> m = ring_mass(density=1300.0, area=math.pi * 1e-6, centre_diameter=23e-3)
    >>> print(f"{m * 1e3:.3f} g")
    0.295 g
    """
    return math.pi * density * area * centre_diameter


@geometry
def oil_mass(*, density: Array, volume: Array) -> Array:
    """Mass of the oil in a volume, rho V.

    Parameters
    ----------
    density : [kg/m^3]
    volume : [m^3]

    Returns
    -------
    mass [kg]

    Notes
    -----
    Valid: full of oil.

    References
    ----------
    [derived] definition of the density

    Examples
    --------
    >>> round(oil_mass(density=870.0, volume=60e-6), 4)
    0.0522
    """
    return density * volume
