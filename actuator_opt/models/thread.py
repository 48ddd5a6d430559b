"""Two engaged ISO 60 degree threads: shear areas, flank pressure, and radial spreading.

Each thread is checked against the strength of its own metal. The wall under a thread
is treated as a tube (`rod.section_area`, `barrel.bore_stresses`) from the thread's root to the
wall's other face.
"""

from __future__ import annotations

from math import pi, tan

from ..base.numeric import Array, geometry, namespace, positive, real, sqrt, where
from .mass import pitch_diameter

HEIGHT = 3**0.5 / 2
"""Ratio of the height H of an ISO thread's sharp triangle to its pitch [ISO68-1]."""

RUN_OUT = 0.8
"""Length of thread that carries no load, in pitches: chamfer and run-out [VDI2230]."""

FLANK = pi / 6
"""Flank angle: half of the thread's 60 degrees [rad]."""

LEAST_OVERLAP = 0.8
"""Least allowed radial overlap of the flanks, as a share of the overlap with full crests. Our
choice: the share that the tolerance 6g leaves at a pitch of 1 mm."""

MALE = (5.594, -13.682, 14.107, -6.057, 0.9353)
FEMALE = (0.728, 1.769, -2.896, 1.296)
LEAST = 0.897
"""Alexander's factors on strip strength: `MALE` and `FEMALE` are the coefficients of polynomials in
the strength ratio; `LEAST` is their value at ratio 1."""


@geometry
def minor_diameter(*, diameter: Array, pitch: Array) -> Array:
    """Minor diameter of the female thread, D_1 = d - 1.25 H, H = (sqrt(3)/2) P.

    Parameters
    ----------
    diameter : nominal diameter d [m]
    pitch : P [m]

    Returns
    -------
    diameter [m]

    Notes
    -----
    Valid: ISO 60 degree threads, basic sizes.

    References
    ----------
    [ISO68-1] basic profile; [ISO724]

    Examples
    --------
    >>> print(f"{minor_diameter(diameter=26e-3, pitch=1e-3) * 1e3:.4f} mm")
    24.9175 mm
    """
    return diameter - 1.25 * HEIGHT * pitch


@geometry
def root_diameter(*, diameter: Array, pitch: Array) -> Array:
    """Diameter at the root of the male thread, d_3 = d - 17 H/12, H = (sqrt(3)/2) P.

    Parameters
    ----------
    diameter : nominal diameter d [m]
    pitch : P [m]

    Returns
    -------
    diameter [m]

    Notes
    -----
    Valid: ISO 60 degree threads with a root of radius H/6.

    References
    ----------
    [ISO68-1] design profile

    Examples
    --------
    >>> print(f"{root_diameter(diameter=26e-3, pitch=1e-3) * 1e3:.4f} mm")
    24.7731 mm
    """
    return diameter - 17 / 12 * HEIGHT * pitch


@geometry
def engaged_length(*, length: Array, pitch: Array) -> Array:
    """Load-carrying length of two threads that overlap by L, L_e = L - 0.8 P.

    Parameters
    ----------
    length : L, axial overlap of the threads [m]
    pitch : P [m]

    Returns
    -------
    length [m]

    Notes
    -----
    Valid: one chamfer and one run-out.

    References
    ----------
    [VDI2230] loss of 0.8 P

    Examples
    --------
    >>> print(f"{engaged_length(length=8e-3, pitch=1e-3) * 1e3:.1f} mm")
    7.2 mm
    """
    return length - RUN_OUT * pitch


@geometry
def male_strip_area(*, diameter: Array, pitch: Array, engagement: Array) -> Array:
    """Shear area of the male thread, which strips off at the crests of the female thread.

    A = pi D_1 (L_e/P) [P/2 + (d_2 - D_1)/3**0.5] = 0.75 pi D_1 L_e, with the pitch diameter d_2
    and the minor diameter D_1 of the female thread.

    Parameters
    ----------
    diameter : nominal diameter [m]
    pitch : P [m]
    engagement : engaged length L_e [m]

    Returns
    -------
    area [m^2]

    Notes
    -----
    Valid: ISO 60 degree threads, basic sizes; the worst tolerances reduce the area by some 10 %.

    References
    ----------
    [FED-STD-H28], [VDI2230] section 5.5.5

    Examples
    --------
    >>> area = male_strip_area(diameter=26e-3, pitch=1e-3, engagement=7.2e-3)
    >>> print(f"{area * 1e6:.3f} mm^2")
    422.715 mm^2
    """
    minor = minor_diameter(diameter=diameter, pitch=pitch)
    width = pitch / 2 + (pitch_diameter(diameter=diameter, pitch=pitch) - minor) / 3**0.5
    return pi * minor * (engagement / pitch) * width


@geometry
def female_strip_area(
    *, diameter: Array, pitch: Array, engagement: Array, crest_diameter: Array
) -> Array:
    """Shear area of the female thread, which strips off at the crests of the male thread.

    A = pi d_c (L_e/P) [P/2 + (d_c - D_2)/3**0.5], with the pitch diameter D_2; with full crests
    (d_c = d), A = 0.875 pi d L_e.

    Parameters
    ----------
    diameter : nominal diameter d [m]
    pitch : P [m]
    engagement : engaged length L_e [m]
    crest_diameter : d_c over the crests of the male thread; below d if the thread is cut on a tube
        whose outer diameter is below d [m]

    Returns
    -------
    area [m^2]

    Notes
    -----
    Valid: ISO 60 degree threads, basic sizes; the worst tolerances reduce the area by some 10 %.

    References
    ----------
    [FED-STD-H28], [VDI2230] section 5.5.5

    Examples
    --------
    >>> size = {"diameter": 26e-3, "pitch": 1e-3, "engagement": 7.2e-3}
    >>> area = female_strip_area(**size, crest_diameter=26e-3)
    >>> print(f"{area * 1e6:.3f} mm^2")
    514.593 mm^2
    """
    width = pitch / 2 + (crest_diameter - pitch_diameter(diameter=diameter, pitch=pitch)) / 3**0.5
    return pi * crest_diameter * (engagement / pitch) * width


@geometry
def crest_overlap(*, diameter: Array, pitch: Array, crest_diameter: Array) -> Array:
    """Radial overlap of the flanks as a share of that with full crests, (d_c - D_1)/(d - D_1).

    D_1 is the minor diameter of the female thread.

    Parameters
    ----------
    diameter : nominal diameter d [m]
    pitch : P [m]
    crest_diameter : diameter d_c over the crests of the male thread [m]

    Returns
    -------
    share [-]; below zero where the threads do not meet

    Notes
    -----
    Valid: ISO 60 degree threads, basic sizes.

    References
    ----------
    [ISO68-1] basic profile

    Examples
    --------
    >>> print(f"{crest_overlap(diameter=26e-3, pitch=1e-3, crest_diameter=25.8e-3):.3f}")
    0.815
    """
    minor = minor_diameter(diameter=diameter, pitch=pitch)
    return (crest_diameter - minor) / (diameter - minor)


@geometry
def flank_area(*, diameter: Array, pitch: Array, engagement: Array, crest_diameter: Array) -> Array:
    """Projected area of the flanks in contact, A = pi d_2 (d_c - D_1)/2 (L_e/P).

    d_2 is the pitch diameter, D_1 the minor diameter of the female thread. With full crests the
    flanks overlap by (d - D_1)/2 = (5/8) H.

    Parameters
    ----------
    diameter : nominal diameter d [m]
    pitch : P [m]
    engagement : engaged length L_e [m]
    crest_diameter : diameter d_c over the crests of the male thread [m]

    Returns
    -------
    area [m^2]

    Notes
    -----
    Valid: ISO 60 degree threads, basic sizes, all turns equally loaded.

    References
    ----------
    [ISO724] sizes; [derived] overlap of the flanks

    Examples
    --------
    >>> area = flank_area(diameter=26e-3, pitch=1e-3, engagement=7.2e-3, crest_diameter=26e-3)
    >>> print(f"{7273.57 / area / 1e6:.2f} MPa")
    23.44 MPa
    """
    overlap = (crest_diameter - minor_diameter(diameter=diameter, pitch=pitch)) / 2
    return pi * pitch_diameter(diameter=diameter, pitch=pitch) * overlap * (engagement / pitch)


def stripping_reductions(*, strength_ratio: Array) -> tuple[Array, Array]:
    """Factors by which bending of the turns reduces the strip strength of both threads.

    C_2 = 5.594 - 13.682 R + 14.107 R^2 - 6.057 R^3 + 0.9353 R^4 for 1 < R < 2.2, 0.897 for R <= 1;
    C_3 = 0.728 + 1.769 R - 2.896 R^2 + 1.296 R^3 for 0.4 < R < 1, 0.897 for R >= 1.

    Parameters
    ----------
    strength_ratio : R, (strength x strip area) of the female thread / that of the male [-]

    Returns
    -------
    C_2 of the male thread, C_3 of the female thread [-]

    Notes
    -----
    Valid: R 0.4 to 2.2; outside, the value at the nearer end.

    References
    ----------
    [Alexander1977], [VDI2230]

    Examples
    --------
    >>> male, female = stripping_reductions(strength_ratio=1.08092)
    >>> print(f"{male:.5f}, {female:.3f}")
    0.91452, 0.897
    """
    ratio = strength_ratio
    over = where(real(ratio) > 1, where(real(ratio) < 2.2, ratio, 2.2 + 0 * ratio), 1 + 0 * ratio)
    under = where(real(ratio) < 1, where(real(ratio) > 0.4, ratio, 0.4 + 0 * ratio), 1 + 0 * ratio)
    male, female = (
        sum(factor * base**power for power, factor in enumerate(law))
        for law, base in ((MALE, over), (FEMALE, under))
    )
    least = LEAST + 0 * ratio
    return where(real(ratio) > 1, male, least), where(real(ratio) < 1, female, least)


@geometry
def spread_stress(*, force: Array, thickness: Array, engagement: Array) -> Array:
    """Hoop stress in a thin ring with a female thread, which the force on the flanks widens.

    sigma = p_s d_2/(2 t) = F tan(30 deg)/(2 pi L_e t), with the pitch diameter d_2, because
    p_s = F tan(30 deg)/(pi d_2 L_e) is the radial pressure on the thread.

    Parameters
    ----------
    force : axial force [N]
    thickness : wall thickness t of the ring outside the thread [m]
    engagement : engaged length L_e [m]

    Returns
    -------
    stress [Pa]

    Notes
    -----
    Valid: thin ring, no friction on the flanks (which would help), all turns equally loaded.

    References
    ----------
    [derived] radial share of the force on the flanks, thin ring

    Examples
    --------
    >>> stress = spread_stress(force=7273.57, thickness=2e-3, engagement=7.2e-3)
    >>> print(f"{stress / 1e6:.2f} MPa")
    46.41 MPa
    """
    return force * tan(FLANK) / (2 * pi * thickness * engagement)


@geometry
def skirt_stresses(
    *,
    force: Array,
    root_diameter: Array,
    thickness: Array,
    engagement: Array,
    poissons_ratio: Array,
) -> tuple[Array, Array, Array]:
    """Stresses of a plug's skirt with a male thread, outside the plate that presses on it.

    Plate and thread press the skirt along its axis, F/A, and the flanks squeeze it, sigma_h as in
    `spread_stress`. At the plate, which holds its radius, it bends: sqrt(3/(1 - nu^2)) sigma_h.

    Parameters
    ----------
    force : axial force F [N]
    root_diameter : of the thread [m]
    thickness : wall thickness t under the thread [m]
    engagement : engaged length L_e [m]
    poissons_ratio : nu [-]

    Returns
    -------
    axial and hoop compression, and bending stress [Pa]

    Notes
    -----
    Valid: upper bound of elastic stress, as couples of the thread bend the skirt the other way.

    Finite elements of skirts of 1.1 mm to 3 mm on plates of 4.7 mm to 15 mm, one with the groove of
    a seal, give 0.3 to 0.9 of the sum of axial and bending stress, and less tension than F/A.
    Bending cannot tear the skirt: axial and hoop compression carry the force without it, and the
    couples of the thread relieve the squeeze.

    References
    ----------
    [derived] long tube with a clamped end, under the radial pressure of the flanks

    Examples
    --------
    >>> axial, hoop, bending = skirt_stresses(force=7982.0, root_diameter=22e-3, thickness=1.1e-3,
    ...                                       engagement=6.4e-3, poissons_ratio=0.33)
    >>> print(f"{axial / 1e6:.1f} {hoop / 1e6:.1f} {bending / 1e6:.0f}")
    110.5 104.2 191
    """
    area = pi * thickness * (root_diameter - thickness)
    hoop = spread_stress(force=force, thickness=thickness, engagement=engagement)
    bending = sqrt(3 / (1 - poissons_ratio * poissons_ratio)) * hoop
    return force / area, hoop, bending


@geometry
def internal_wall_stresses(
    *,
    force: Array,
    diameter: Array,
    pitch: Array,
    engagement: Array,
    bore_diameter: Array,
    outer_diameter: Array,
    poissons_ratio: Array,
) -> tuple[Array, Array]:
    """Axial and bending stress of a tube at the inner end of a thread in its bore.

    sigma = F/A between the thread's roots, d, and the outer diameter, with thickness t_n. The force
    N per circumference enters along the engaged length L, at the pitch diameter, so that couples
    N e/L with e = t_n/2 + (d - d_2)/2 bend the end of the tube. At the inner end, the wall becomes
    thicker by h = (d - d_b)/2. sigma_b = 6 M/t_n^2, M = N (e f + h/4),
    f = (exp(-a) sin a + (1 - exp(-2 a) (cos 2a + sin 2a))/4)/a, a = beta L,
    beta^4 = 3 (1 - nu^2)/(r_n t_n)^2.

    Parameters
    ----------
    force : F [N]
    diameter : nominal diameter d [m]
    pitch : P [m]
    engagement : engaged length L [m]
    bore_diameter : d_b, of the tube beside the thread [m]
    outer_diameter : of the layer with the thread [m]
    poissons_ratio : nu, of this layer [-]

    Returns
    -------
    axial stress and bending stress [Pa]

    Notes
    -----
    Valid: turns equally loaded, thread at the end of the tube; layers outside lower the bending.

    Axisymmetric finite elements with t_n = 1.65 mm, h = 0.55 mm and L = 4 mm to 9 mm give 0.94 to 1
    of the sum of both stresses for the bare layer, and 0.75 to 0.83 under 1.5 mm to 3 mm of hoop
    winding, if the force enters at the roots.

    References
    ----------
    [derived] long tube with free end under couples: forces +-m at the ends of their length

    Examples
    --------
    >>> axial, bending = internal_wall_stresses(
    ...     force=7273.57, diameter=22.1e-3, pitch=1e-3, engagement=6e-3, bore_diameter=21e-3,
    ...     outer_diameter=25.4e-3, poissons_ratio=0.33)
    >>> print(f"{axial / 1e6:.2f} {bending / 1e6:.2f}")
    59.08 91.43
    """
    remaining = positive(outer_diameter - diameter) / 2
    radius = (outer_diameter + diameter) / 4
    beta = sqrt(sqrt(3 * (1 - poissons_ratio * poissons_ratio)) / (radius * remaining))
    length, xp = beta * engagement, namespace(outer_diameter)
    fall = xp.exp(-length)
    end = fall * xp.sin(length)
    loaded = (1 - fall * fall * (xp.cos(2 * length) + xp.sin(2 * length))) / 4
    spread = (end + loaded) / length
    line_force = force / (2 * pi * radius)
    lever = (remaining + diameter - pitch_diameter(diameter=diameter, pitch=pitch)) / 2
    moment = line_force * (lever * spread + (diameter - bore_diameter) / 8)
    area = pi * (outer_diameter * outer_diameter - diameter * diameter) / 4
    return force / area, 6 * moment / (remaining * remaining)
