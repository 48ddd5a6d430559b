"""Lip seals (U-cup of piston or rod, wiper at zero pressure): line load, width, peak pressure.

The sliding lip is a short tube of mean radius r, thickness t and length l, clamped where it leaves
the body. The interference delta of its rim with the surface bends it. Seals of piston and rod
differ only in the radius. Loads are per length of circumference; the pressure is the one-sided
difference, >= 0. Without interference (delta <= 0) there is no contact: load, width and peak are
zero.

Under pressure the lip lies down on the surface, from the rim towards the body. The part next to the
root, of length s, still bridges the root clearance g, the gap between root and surface.
"""

from __future__ import annotations

import math

from ..base.numeric import Array, geometry, maximum, minimum, namespace, real, sqrt, where
from .contact_profile import lip_mean

LYING_STEPS = 7
"""Number of Newton steps that find the free span s in `lip_free_span`. They start above the
solution, at the smaller of two spans: that without the equation's linear term, and that without
its quartic term. The function is convex, so they never overshoot. After six steps, even the worst
case is exact to rounding."""


@geometry
def lip_interference(*, section: Array, gland_depth: Array) -> Array:
    """Interference of the sliding lip, delta = (W - depth)/2: both lips deflect equally.

    Parameters
    ----------
    section : free radial height over both lips, W [m]
    gland_depth : radial space [m]

    Returns
    -------
    interference of one lip [m]; <= 0: no contact

    Notes
    -----
    Valid: two like lips, body free to settle radially; with a clamped body, twice as much.

    References
    ----------
    [derived] equal loads on equal springs

    Examples
    --------
    >>> print(f"{lip_interference(section=6.4e-3, gland_depth=5.4e-3) * 1e3:.2f} mm")
    0.50 mm
    """
    return (section - gland_depth) / 2


def _plate_stiffness(youngs_modulus: Array, poissons_ratio: Array, thickness: Array) -> Array:
    return youngs_modulus * thickness**3 / (12 * (1 - poissons_ratio * poissons_ratio))


@geometry
def lip_stiffness(
    *,
    youngs_modulus: Array,
    poissons_ratio: Array,
    lip_thickness: Array,
    lip_length: Array,
    lip_radius: Array,
) -> Array:
    """Rim load divided by rim deflection of a lip: a clamped short tube with a radial edge load.

    k = 2 D beta^3 (cosh^2 u + cos^2 u)/(sinh u cosh u - sin u cos u), u = beta l,
    D = E t^3/[12 (1 - nu^2)], beta^4 = E t/(4 D r^2). A large radius gives the cantilever 3 D/l^3,
    a long lip 2 D beta^3.

    Parameters
    ----------
    youngs_modulus, poissons_ratio : of the lip [Pa], [-]
    lip_thickness : t, mean over the length [m]
    lip_length : l, from the root to the rim [m]
    lip_radius : r, mean radius of the lip [m]

    Returns
    -------
    stiffness per length of circumference [N/m^2]

    Notes
    -----
    Valid: t < r/3 and t < l/2; shear and the seal body's flexibility are neglected (k too high).

    References
    ----------
    [Timoshenko1959] tube under loads symmetric about its axis; [derived] clamped root, loaded rim

    Examples
    --------
    >>> k = lip_stiffness(youngs_modulus=43e6, poissons_ratio=0.48, lip_thickness=2e-3,
    ...                   lip_length=6e-3, lip_radius=40e-3)
    >>> print(f"{k / 1e6:.4f} N/mm per mm")
    0.5930 N/mm per mm
    """
    bending = _plate_stiffness(youngs_modulus, poissons_ratio, lip_thickness)
    square = sqrt(youngs_modulus * lip_thickness / (4 * bending)) / lip_radius
    beta = sqrt(square)
    u = minimum(beta * lip_length, 20.0)  # from there on both limits agree to rounding
    xp = namespace(u)
    w = 2 * u
    small = real(w) < 0.5
    safe = where(small, 1.0, w)
    fourth = w**4
    series = w**3 / 3 * (1 + fourth / 840 + fourth * fourth / 6652800)
    falling = where(small, series, xp.sinh(safe) - xp.sin(safe)) / 2
    return 2 * bending * beta**3 * (xp.cosh(u) ** 2 + xp.cos(u) ** 2) / falling


@geometry
def lip_free_span(
    *,
    interference: Array,
    root_clearance: Array,
    pressure: Array,
    youngs_modulus: Array,
    poissons_ratio: Array,
    lip_thickness: Array,
    lip_length: Array,
) -> Array:
    """Length s of the lip that does not lie on the surface, from p s^4/(72 D) + theta s/3 = g.

    theta = (g + delta)/l is the slope of the free lip, g the clearance at its root, and D the
    bending stiffness in `lip_stiffness`. s = l while only the rim touches, so the lip lies down
    above p = 24 D (2 g - delta)/l^4.

    Parameters
    ----------
    interference : delta of the rim [m]
    root_clearance : g, from the surface to the lip at its root [m]
    pressure : [Pa]
    youngs_modulus, poissons_ratio : of the lip [Pa], [-]
    lip_thickness, lip_length : t, l [m]

    Returns
    -------
    span s, 0 to l [m]; l without interference

    Notes
    -----
    Valid: straight thin lip on a flat surface, hoop stiffness and shear neglected.

    References
    ----------
    [derived] beam under uniform load, clamped at the root, touching down with the surface's slope
    and no curvature

    Examples
    --------
    >>> s = lip_free_span(interference=0.5e-3, root_clearance=0.4e-3, pressure=2e6,
    ...     youngs_modulus=43e6, poissons_ratio=0.48, lip_thickness=2e-3, lip_length=6e-3)
    >>> print(f"{s * 1e3:.4f} mm")
    4.0373 mm
    """
    touching = (real(interference) > 0) & (real(root_clearance) > 0)
    gap = where(touching, root_clearance, 1e-3 * lip_length)
    slope = (gap + where(touching, interference, lip_length)) / lip_length / 3
    bending = _plate_stiffness(youngs_modulus, poissons_ratio, lip_thickness)
    load = pressure / (72 * bending)
    straight = gap / slope
    bent = real(load * straight**4) > real(gap)
    quartic = sqrt(sqrt(gap / where(bent, load, 1.0)))
    span = where(bent, quartic, straight)
    for _ in range(LYING_STEPS):
        cube = span * span * span
        span = span - (load * cube * span + slope * span - gap) / (4 * load * cube + slope)
    span = minimum(span, lip_length)
    return where(real(interference) > 0, where(real(root_clearance) > 0, span, 0.0), lip_length)


@geometry
def line_load(
    *,
    interference: Array,
    root_clearance: Array,
    pressure: Array,
    youngs_modulus: Array,
    poissons_ratio: Array,
    lip_thickness: Array,
    lip_length: Array,
    lip_radius: Array,
) -> Array:
    """Line load of a lip: its preload plus the share of the pressure that the surface carries.

    While only the rim touches, f = k delta + 3 p l/8 (propped cantilever). Once the lip lies down
    with a free span s, f = (k - 3 D/l^3) delta + p s/3 + 2 D theta/s^2 + p (l - s); the transition
    is continuous. `lip_stiffness` defines k and D, `lip_free_span` s and theta. A span shorter than
    the lip's thickness is no beam, so for s < t the bending term keeps its value at s = t.

    Parameters
    ----------
    interference : delta of the rim [m]
    root_clearance : g, from the surface to the lip at its root [m]
    pressure : one-sided difference [Pa]
    youngs_modulus, poissons_ratio : of the lip [Pa], [-]
    lip_thickness, lip_length, lip_radius : t, l, mean radius r [m]

    Returns
    -------
    line load [N/m]; 0 without interference

    Notes
    -----
    Valid: as `lip_stiffness`; that hoop stiffness carries part of the pressure is neglected.

    Oil pressure inside the contact is not subtracted: a film carries its part of this load.

    References
    ----------
    [derived] `lip_stiffness` and the beam of `lip_free_span`

    Examples
    --------
    >>> lip = {"interference": 0.5e-3, "root_clearance": 0.4e-3, "youngs_modulus": 43e6,
    ...        "poissons_ratio": 0.48, "lip_thickness": 2e-3, "lip_length": 6e-3,
    ...        "lip_radius": 40e-3}
    >>> print(", ".join(f"{line_load(pressure=p, **lip) / 1e3:.3f}" for p in (0.0, 1e6, 1e7)))
    0.297, 3.485, 42.195
    """
    stiffness = lip_stiffness(
        youngs_modulus=youngs_modulus,
        poissons_ratio=poissons_ratio,
        lip_thickness=lip_thickness,
        lip_length=lip_length,
        lip_radius=lip_radius,
    )
    span = lip_free_span(
        interference=interference,
        root_clearance=root_clearance,
        pressure=pressure,
        youngs_modulus=youngs_modulus,
        poissons_ratio=poissons_ratio,
        lip_thickness=lip_thickness,
        lip_length=lip_length,
    )
    bending = _plate_stiffness(youngs_modulus, poissons_ratio, lip_thickness)
    rim = stiffness * interference + 0.375 * pressure * lip_length
    slope = (root_clearance + interference) / lip_length
    bend = 2 * bending * slope / maximum(span, lip_thickness) ** 2
    flat = (stiffness - 3 * bending / lip_length**3) * interference
    lying = flat + bend + pressure * (lip_length - 2 * span / 3)
    load = where(real(span) < real(lip_length), lying, rim)
    return where(real(interference) > 0, load, 0.0)


@geometry
def peak_pressure(
    *,
    interference: Array,
    pressure: Array,
    youngs_modulus: Array,
    poissons_ratio: Array,
    lip_thickness: Array,
    lip_length: Array,
    lip_radius: Array,
    edge_radius: Array,
) -> Array:
    """Highest contact pressure of a lip, p_max = sqrt(F E/[pi rho (1 - nu^2)]) + p, F = k delta.

    k is the stiffness of `lip_stiffness`.

    Parameters
    ----------
    interference : delta of the rim [m]
    pressure : one-sided difference [Pa]
    youngs_modulus, poissons_ratio : of the lip [Pa], [-]
    lip_thickness, lip_length, lip_radius : t, l, mean radius r [m]
    edge_radius : rho of the rim [m]

    Returns
    -------
    peak pressure, relative to the low-pressure side [Pa]; 0 without interference

    Notes
    -----
    Valid: Hertz width well below the lip's thickness; a nearly incompressible lip.

    References
    ----------
    [Johnson1985] line contact of a cylinder; [derived] an incompressible lip passes the sealed
    pressure on in full

    Examples
    --------
    >>> p = peak_pressure(interference=0.5e-3, pressure=2e6, youngs_modulus=43e6,
    ...     poissons_ratio=0.48, lip_thickness=2e-3, lip_length=6e-3, lip_radius=40e-3,
    ...     edge_radius=0.2e-3)
    >>> print(f"{p / 1e6:.3f} MPa")
    7.135 MPa
    """
    stiffness = lip_stiffness(
        youngs_modulus=youngs_modulus,
        poissons_ratio=poissons_ratio,
        lip_thickness=lip_thickness,
        lip_length=lip_length,
        lip_radius=lip_radius,
    )
    touching = real(interference) > 0
    preload = stiffness * where(touching, interference, 1.0)
    stiff = youngs_modulus / (1 - poissons_ratio * poissons_ratio)
    return where(touching, sqrt(preload * stiff / (math.pi * edge_radius)) + pressure, 0.0)


@geometry
def contact_width(
    *, line_load: Array, peak_pressure: Array, pressure: Array, lip_length: Array
) -> Array:
    """Contact width of a lip from its load and peak, b = f/m, at most l.

    m is the mean of the contact pressure in `contact_profile.lip_profile`, which runs from the
    sealed pressure on one side to zero on the other, with the peak p_max. Load, peak, width and
    profile therefore agree. The lip lies down from the rim towards its root as the pressure grows.

    Parameters
    ----------
    line_load : f, see `line_load` [N/m]
    peak_pressure : p_max, see `peak_pressure` [Pa]
    pressure : one-sided difference [Pa]
    lip_length : l [m]

    Returns
    -------
    contact width [m]; 0 without load

    Notes
    -----
    Valid: as `line_load`; where b = l, the profile must peak above p_max to carry f.

    References
    ----------
    [derived] load balance of the lip profile

    Examples
    --------
    >>> b = contact_width(line_load=3485.0, peak_pressure=6.135e6, pressure=1e6, lip_length=6e-3)
    >>> print(f"{b * 1e3:.4f} mm")
    1.1012 mm
    """
    mean = lip_mean(sealed_pressure=pressure, outer_pressure=0.0, excess=peak_pressure - pressure)
    loaded = (real(line_load) > 0) & (real(mean) > 0)
    width = line_load / where(loaded, mean, 1.0)
    return where(loaded, minimum(width, lip_length), 0.0)
