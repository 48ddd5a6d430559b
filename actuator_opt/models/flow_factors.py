"""Flow and shear factors of isotropic rough surfaces (Patir and Cheng), over H = h/sigma.

`rod_share` is V = (sigma_rod/sigma)^2, the part of the composite roughness that lies on the moving
rod: 0 for a smooth rod under a rough seal, 1 for a rough rod under a smooth seal. It sets the sign
of the two factors of relative motion: with a smooth rod the flow is less than that of a smooth
gap and the shear of the rod more.
"""

from __future__ import annotations

from ..base.numeric import Array, maximum, namespace, real, where


def pressure_flow_factor(*, film_ratio: Array) -> Array:
    """Flow under a pressure gradient over that of a smooth gap, phi_x = 1 - 0.90 e^(-0.56 H).

    Parameters
    ----------
    film_ratio : H [-]

    Returns
    -------
    phi_x [-]; below H = 0 the value there

    Notes
    -----
    Valid: H > 0.5, continued by the same law down to 0.

    References
    ----------
    [PatirCheng1978] isotropic roughness

    Examples
    --------
    >>> print(f"{pressure_flow_factor(film_ratio=2.5):.6f}")
    0.778063
    """
    film = maximum(film_ratio, 0.0)
    return 1 - 0.90 * namespace(film).exp(-0.56 * film)


def shear_flow_factor(*, film_ratio: Array, rod_share: Array) -> Array:
    """Flow carried by the roughness, phi_s = (2 V - 1) Phi_s, over (U/2) sigma.

    Phi_s = 1.899 H^0.98 e^(-0.92 H + 0.05 H^2) to H = 5, 1.126 e^(-0.25 H) beyond. The flow of
    the motion is (U/2)(h_T + sigma phi_s) for a rod of speed U.

    Parameters
    ----------
    film_ratio : H [-]
    rod_share : V = (sigma_rod/sigma)^2 [-], 0 to 1

    Returns
    -------
    phi_s [-]; 0 at H <= 0

    Notes
    -----
    Valid: H > 0.5, continued by the same law down to 0.

    References
    ----------
    [PatirCheng1979] isotropic roughness

    Examples
    --------
    >>> print(f"{shear_flow_factor(film_ratio=2.5, rod_share=0.0):.6f}")
    -0.638772
    """
    xp = namespace(film_ratio)
    thin = (real(film_ratio) > 0) & (real(film_ratio) <= 5)
    low = where(thin, film_ratio, 1.0)
    high = where(real(film_ratio) > 5, film_ratio, 5.0)
    inner = 1.899 * low**0.98 * xp.exp(low * (0.05 * low - 0.92))
    outer = 1.126 * xp.exp(-0.25 * high)
    factor = where(thin, inner, where(real(film_ratio) > 5, outer, 0.0))
    return (2 * rod_share - 1) * factor


def shear_stress_factor(*, film_ratio: Array) -> Array:
    """Mean of h over the local gap, phi_f: sliding shear over that of a smooth gap.

    The polynomial density of heights of Patir and Cheng, z = H/3, with the gap cut off at
    1/300 of its range.

    Parameters
    ----------
    film_ratio : H [-]

    Returns
    -------
    phi_f [-]; 0 at H <= 0

    Notes
    -----
    Valid: H > 0.5; from H = 30 the series 1 + 1/H^2 + 2.4545/H^4.

    References
    ----------
    [PatirCheng1979] shear stress factors

    Examples
    --------
    >>> print(f"{shear_stress_factor(film_ratio=2.5):.6f}")
    1.379666
    """
    xp = namespace(film_ratio)
    near = (real(film_ratio) > 0) & (real(film_ratio) <= 3)
    middle = (real(film_ratio) > 3) & (real(film_ratio) <= 30)
    z = where(near, film_ratio, 1.5) / 3
    well = (1 - z * z) * (1 - z * z) * (1 - z * z)
    tail = -55 + z * (132 + z * (345 + z * (-160 + z * (-405 + z * (60 + 147 * z)))))
    touching = (35 / 32) * z * (well * xp.log(300 * (z + 1)) + tail / 60)
    z = where(middle, film_ratio, 6.0) / 3
    square = z * z
    well = (1 - square) * (1 - square) * (1 - square)
    tail = (z / 15) * (66 + square * (30 * square - 80))
    apart = (35 / 32) * z * (well * xp.log((z + 1) / (z - 1)) + tail)
    square = where(real(film_ratio) > 30, film_ratio, 31.0)
    square = square * square
    thick = 1 + 1 / square + 2.4545 / (square * square)
    separated = where(middle, apart, thick)
    return where(real(film_ratio) > 0, where(near, touching, separated), 0 * separated)


def shear_stress_correction(*, film_ratio: Array, rod_share: Array) -> Array:
    """Shear by the flow of the roughness, phi_fs = (2 V - 1) Phi_fs, taken from phi_f.

    Phi_fs = 11.1 H^2.31 e^(-2.38 H + 0.11 H^2) to H = 7, 0 beyond. The sliding shear of the rod
    is (eta U/h)(phi_f - phi_fs): a smooth rod has phi_f + Phi_fs.

    Parameters
    ----------
    film_ratio : H [-]
    rod_share : V = (sigma_rod/sigma)^2 [-], 0 to 1

    Returns
    -------
    phi_fs [-]; 0 at H <= 0 and above 7

    Notes
    -----
    Valid: H > 0.5, continued by the same law down to 0.

    References
    ----------
    [PatirCheng1979] shear stress factors

    Examples
    --------
    >>> print(f"{shear_stress_correction(film_ratio=2.5, rod_share=0.0):.6f}")
    -0.477628
    """
    inside = (real(film_ratio) > 0) & (real(film_ratio) < 7)
    film = where(inside, film_ratio, 1.0)
    value = 11.1 * film**2.31 * namespace(film).exp(film * (0.11 * film - 2.38))
    return (2 * rod_share - 1) * where(inside, value, 0 * value)


def pressure_stress_factor(*, film_ratio: Array) -> Array:
    """Shear under a pressure gradient over that of a smooth gap, phi_fp = 1 - 1.40 e^(-0.66 H).

    Parameters
    ----------
    film_ratio : H [-]

    Returns
    -------
    phi_fp [-], not below 0

    Notes
    -----
    Valid: H > 0.75, continued by the same law until it is 0 at H = 0.51.

    References
    ----------
    [PatirCheng1979] shear stress factors

    Examples
    --------
    >>> print(f"{pressure_stress_factor(film_ratio=2.5):.6f}")
    0.731130
    """
    return maximum(1 - 1.40 * namespace(film_ratio).exp(-0.66 * film_ratio), 0.0)
