"""Three-point bending test: from the force-deflection slope to a modulus, and back.

The specimen lies on two supports a span L apart and is loaded in the middle. Bending, shear and the
indentation at load and supports are springs in series.
"""

from __future__ import annotations

from collections.abc import Sequence

from ..base.numeric import Array, geometry, positive, sqrt


@geometry
def bending_modulus(
    *,
    slope: Array,
    span: Array,
    second_moment: Array,
    shear_compliance: Array = 0.0,
    local_compliance: Array = 0.0,
) -> Array:
    """Modulus from a bending test, with shear and local dents subtracted from the deflection.

    E = L^3/(48 I)/(1/k0 - L/(4 S) - C), 1/S = `shear_compliance`. For a stepped specimen,
    pass the second moment from `equivalent_second_moment`.

    Parameters
    ----------
    slope : k0, force divided by deflection, both at mid-span [N/m]
    span : L between the supports [m]
    second_moment : I of the section, or the equivalent value [m^4]
    shear_compliance : 1/(kappa G A) [1/N]; for a stepped specimen its mean along the span
    local_compliance : C, deflection per force at load and supports, measured or from
        `indentation_compliance` [m/N]

    Returns
    -------
    bending modulus [Pa]; NaN where shear and dents alone exceed the deflection

    Notes
    -----
    Valid: linear, small deflection; shear stiffness known from elsewhere.

    References
    ----------
    [ElAsswad2018] eq. 13; [derived] springs in series, shear force F/2 on either side

    Examples
    --------
    >>> e = bending_modulus(slope=150e3, span=0.3, second_moment=7e-9, shear_compliance=5e-6,
    ...                     local_compliance=4e-7)
    >>> print(f"{e / 1e9:.3f} GPa")
    13.639 GPa
    """
    bent = 1 / slope - span * shear_compliance / 4 - local_compliance
    return span * span * span / (48 * second_moment) / positive(bent)


@geometry
def bending_slope(
    *,
    youngs_modulus: Array,
    span: Array,
    second_moment: Array,
    shear_compliance: Array = 0.0,
    local_compliance: Array = 0.0,
) -> Array:
    """Force-deflection slope that a bending test will show: the inverse of `bending_modulus`.

    1/k0 = L^3/(48 EI) + L/(4 S) + C, 1/S = `shear_compliance`.

    Parameters
    ----------
    youngs_modulus : E along the specimen [Pa]
    span : L between the supports [m]
    second_moment : I of the section, or of `equivalent_second_moment` [m^4]
    shear_compliance : 1/(kappa G A) [1/N]
    local_compliance : C, deflection per force at load and supports [m/N]

    Returns
    -------
    k0 [N/m]

    Notes
    -----
    Valid: linear, small deflection.

    References
    ----------
    [ElAsswad2018] eq. 13; [derived] springs in series, shear force F/2 on either side

    Examples
    --------
    >>> k = bending_slope(youngs_modulus=60e9, span=0.3, second_moment=7e-9,
    ...                   shear_compliance=5e-6, local_compliance=4e-7)
    >>> print(f"{k / 1e3:.2f} N/mm")
    472.97 N/mm
    """
    bent = span * span * span / (48 * youngs_modulus * second_moment)
    return 1 / (bent + span * shear_compliance / 4 + local_compliance)


@geometry
def equivalent_second_moment(
    *, second_moments: Sequence[Array], steps: Sequence[Array], span: Array
) -> Array:
    """Second moment of the uniform specimen that bends as much as a stepped, symmetric specimen.

    1/I = sum (z_j^3 - z_(j-1)^3)/I_j over the steps from support to middle, z = 2 x/L.

    Parameters
    ----------
    second_moments : I of each part from the support to the middle [m^4]; for a part of
        another modulus E_j, E_j/E times its I, with the modulus E of the other parts
    steps : distance of each change of section from the support, one fewer than parts [m]
    span : L between the supports [m]

    Returns
    -------
    second moment [m^4]

    Notes
    -----
    Valid: steps inside half the span; for unequal halves, take the mean of both 1/I.

    References
    ----------
    [derived] unit load: deflection per force = int (x/2)^2/(E I) dx over both halves

    Examples
    --------
    >>> i = equivalent_second_moment(second_moments=[30e-9, 7e-9], steps=[30e-3], span=0.3)
    >>> print(f"{i * 1e12:.1f} mm^4")
    7043.2 mm^4
    """
    inverse: Array = 0.0
    before: Array = 0.0
    for second_moment, step in zip(second_moments, [*steps, span / 2], strict=True):
        place = 2 * step / span
        cube = place * place * place
        inverse = inverse + (cube - before) / second_moment
        before = cube
    return 1 / inverse


@geometry
def indentation_compliance(
    *, force: Array, roller_radius: Array, specimen_radius: Array, contact_modulus: Array
) -> Array:
    """Local deflection per force where three round rollers cross a round specimen, by Hertz.

    One contact: delta = (9 F^2/(16 R E*^2))^(1/3), R = sqrt(R1 R2), slope 2 delta/(3 F). The
    supports carry F/2 each: C = (2 delta/(3 F)) (1 + 2^(1/3)/2).

    Parameters
    ----------
    force : F in the middle, where the slope is taken [N]
    roller_radius : R1 of all three rollers [m]
    specimen_radius : R2, outer radius of the specimen [m]
    contact_modulus : E*, 1/E* = (1 - nu_1^2)/E_1 + (1 - nu_2^2)/E_2; across the fibres where the
        specimen is laminated [Pa]

    Returns
    -------
    tangent compliance [m/N]

    Notes
    -----
    Valid: an estimate: solid elastic bodies, R1/R2 from 1/4 to 4 within 3 %.

    A thin tube also flattens under the rollers, which adds far more deflection: measure it on a
    short span.

    References
    ----------
    [Johnson1985] point contact of crossed cylinders, mean radius; [derived] three contacts

    Examples
    --------
    >>> c = indentation_compliance(force=500.0, roller_radius=5e-3, specimen_radius=6e-3,
    ...                            contact_modulus=9e9)
    >>> print(f"{c * 1e9:.1f} um/kN")
    148.2 um/kN
    """
    radius = sqrt(roller_radius * specimen_radius)
    squeeze = 9 / (16 * radius * contact_modulus * contact_modulus * force)
    return 2 / 3 * (1 + 2 ** (1 / 3) / 2) * squeeze ** (1 / 3)
