"""Step seals: a sliding ring of filled PTFE pressed on rod or bore by an O-ring behind it.

The ring is in radial balance. Two loads act on its back: the line load of the energiser (a law of
`seals.LAWS`), and the pressure on the part of the back that lies on the pressure side of the
energiser's contact. On its front, the pressure acts on the relief of the running face, on the
pressure side of the land. The land carries the difference. Loads are per length of circumference;
the pressure is the one-sided difference, >= 0. If the energiser is not squeezed, there is no
contact: load and width are zero. The peak pressure is that of the worn-in land,
`contact_profile.land_peak`.
"""

from __future__ import annotations

from ..base.numeric import Array, geometry, maximum, real, sqrt, where


@geometry
def wetted_back(*, ring_width: Array, foot_width: Array, section: Array, squeeze: Array) -> Array:
    """Length of the ring's back that the pressure wets, a_b = w - b - W (1 - C)/2, at least 0.

    The pressure has pushed the O-ring to the outer side. A dry corner, bounded by the rounded side
    of the squeezed section, remains between the O-ring's contact and the groove's outer wall. Under
    pressure this contact widens into that corner, so a_b does not change.

    Parameters
    ----------
    ring_width : axial width w of the sliding ring [m]
    foot_width : contact width b of the energiser without pressure [m]
    section, squeeze : free section W and squeeze C of the energiser [m], [-]

    Returns
    -------
    wetted length [m]

    Notes
    -----
    Valid: one-sided pressure, groove as wide as the ring, squeeze 0.1 to 0.3.

    References
    ----------
    [derived] squeezed ring as a stadium against the outer wall

    Examples
    --------
    >>> a = wetted_back(ring_width=3.9e-3, foot_width=1.13e-3, section=2.62e-3, squeeze=0.15)
    >>> print(f"{a * 1e3:.4f} mm")
    1.6565 mm
    """
    return maximum(ring_width - foot_width - section * (1 - squeeze) / 2, 0.0)


@geometry
def line_load(
    *,
    energiser_load: Array,
    pressure: Array,
    wetted_back: Array,
    wetted_front: Array,
) -> Array:
    """Line load of the land, f = f_e + p (a_b - a_f), at least 0 (the ring has lifted).

    Parameters
    ----------
    energiser_load : f_e(C, p) of the energiser's contact law [N/m]
    pressure : one-sided difference [Pa]
    wetted_back : a_b, see `wetted_back` [m]
    wetted_front : a_f, width of the relief of the running face on the pressure side of the land [m]

    Returns
    -------
    line load [N/m]; 0 without energiser load

    Notes
    -----
    Valid: ring not tilted; the load that the oil under the land carries is not subtracted.

    The hoop tension of the ring is neglected, because creep relaxes it.

    References
    ----------
    [derived] radial balance of the sliding ring

    Examples
    --------
    >>> f = line_load(energiser_load=1.5e4, pressure=5e6, wetted_back=1.66e-3,
    ...               wetted_front=2.4e-3)
    >>> print(f"{f / 1e3:.2f} N/mm")
    11.30 N/mm
    """
    load = maximum(energiser_load + pressure * (wetted_back - wetted_front), 0.0)
    return where(real(energiser_load) > 0, load, 0.0)


@geometry
def contact_width(
    *,
    line_load: Array,
    land: Array,
    taper: Array,
    ring_width: Array,
    youngs_modulus: Array,
    poissons_ratio: Array,
) -> Array:
    """Contact width of a land between shallow tapers, b = sqrt(a^2 + (2 f/(E* alpha))^2).

    E* = E/(1 - nu^2); at most the ring's width.

    Parameters
    ----------
    line_load : f [N/m]
    land : flat width a [m]
    taper : angle alpha between the flanks and the surface, both sides [rad]
    ring_width : axial width of the ring [m]
    youngs_modulus, poissons_ratio : of the ring [Pa], [-]

    Returns
    -------
    contact width [m]; 0 without load

    Notes
    -----
    Valid: alpha < 0.2, b < 2 ring thicknesses (half-space), elastic.

    For flanks of unequal angles their harmonic mean is a close approximation; steep flanks give
    b = a.

    References
    ----------
    [Johnson1985] smooth end of a frictionless plane contact; [derived] its load integral
    f = (E*/2) int h'(x) x/sqrt(b^2/4 - x^2) dx over a truncated wedge

    Examples
    --------
    >>> b = contact_width(line_load=2e4, land=0.8e-3, taper=0.09, ring_width=3.9e-3,
    ...                   youngs_modulus=600e6, poissons_ratio=0.46)
    >>> print(f"{b * 1e3:.4f} mm")
    0.9905 mm
    """
    wedge = 2 * line_load * (1 - poissons_ratio * poissons_ratio) / (youngs_modulus * taper)
    loaded = real(line_load) > 0
    width = sqrt(land * land + wedge * wedge)
    shorter = where(real(width) < real(ring_width), width, ring_width)
    return where(loaded, shorter, 0.0)
