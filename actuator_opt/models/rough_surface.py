"""Rough surfaces: asperity contact, mean gap, and the effect of roughness on a flow.

The film ratio is H = h/sigma: the distance of the mean planes divided by the composite roughness
of a Gaussian surface. Flow and shear factors are those of isotropic surfaces (Patir and Cheng);
`rod_share` is V = (sigma_rod/sigma)^2, the part of the composite roughness on the moving rod: 0 for
a smooth rod under a rough seal, 1 for a rough rod under a smooth seal. V sets the sign of the two
factors for sliding: with a smooth rod, less oil flows than in a smooth gap, and the shear stress on
the rod is higher.
"""

from __future__ import annotations

import math
from functools import cache

import numpy as np

from ..base.numeric import Array, geometry, magnitude, maximum, namespace, real, where

_STEP = 0.15
_HEIGHTS = tuple((_STEP * i) ** 2 for i in range(29))
"""Squares of the nodes s of the trapezium sum in `asperity_integral`; the sum is exact to 1e-11 for
film ratios of -6 to 20."""
_ORDERS = {"-1/2": 0, "1/2": 2, "3/2": 4, "5/2": 6}
"""Power 2n + 1 of s in the integrand of an asperity integral, by its order n; always even."""
_WEIGHTS = {
    order: tuple(
        2 * _STEP / math.sqrt(2 * math.pi) * (0.5 if s == 0 else 1) * s ** (power / 2)
        for s in _HEIGHTS
    )
    for order, power in _ORDERS.items()
}
"""Weights of the trapezium sum at each height, by the order of the asperity integral."""
_FLATTEST = 15.0
"""F_3/2 at about H = -6, the lowest film ratio for which the asperity integral is exact."""
_CERTAIN = 8.5
"""Film ratio beyond which the normal distribution is 0 or 1 to double precision."""


@cache
def _gauss() -> tuple[list[float], list[float]]:
    """Nodes and weights of Gauss and Legendre on 0 to 1."""
    places, shares = np.polynomial.legendre.leggauss(32)  # a slow import, for seal films alone
    return (0.5 * (places + 1)).tolist(), (0.5 * shares).tolist()


def _bells(value: Array) -> Array:
    """exp(-(value + height)^2/2) at every summit height of the sum, on a new last axis."""
    xp = namespace(value)
    column = xp.asarray(value)[..., None] + xp.asarray(_HEIGHTS)
    return xp.exp(-0.5 * column * column)


def _summed(bells: Array, order: str) -> Array:
    """Asperity integral of an order at a film ratio, from the values of `_bells` at this ratio."""
    xp = namespace(bells)
    return xp.sum(xp.asarray(_WEIGHTS[order]) * bells, axis=-1)


def composite_roughness(*, first: Array, second: Array) -> Array:
    """Root-mean-square roughness of the gap between two surfaces, sqrt(s_a^2 + s_b^2).

    Parameters
    ----------
    first, second : root-mean-square roughness Rq of each surface [m]

    Returns
    -------
    composite roughness [m]

    Notes
    -----
    Valid: independent Gaussian surfaces.

    References
    ----------
    [Huang2017] eq. 5

    Examples
    --------
    >>> print(f"{composite_roughness(first=0.8e-6, second=0.6e-6) * 1e6:.4f} um")
    1.0000 um
    """
    return magnitude(first, second)


def asperity_integral(*, film_ratio: Array, order: str = "3/2") -> Array:
    """Asperity integral F_n(H) = (2 pi)^(-1/2) int_H^inf (z - H)^n exp(-z^2/2) dz.

    dF_n/dH = -n F_(n-1). With z - H = s^2 the integrand is even and entire in s, so a trapezium
    sum over s converges faster than any power of its step.

    Parameters
    ----------
    film_ratio : H [-]
    order : n [-], one of "-1/2", "1/2", "3/2", "5/2"

    Returns
    -------
    F_n [-]

    Raises
    ------
    ValueError
        An order that is not in the list.

    Notes
    -----
    Valid: H of -6 to 20.

    References
    ----------
    [Huang2017] eq. 8, 9, [GreenwoodWilliamson1966]

    Examples
    --------
    >>> print(f"{asperity_integral(film_ratio=0.0):.4f}")
    0.4300
    """
    if order not in _ORDERS:
        raise ValueError(f"order {order!r} of an asperity integral: use one of {list(_ORDERS)}")
    return _summed(_bells(film_ratio), order)


@geometry
def asperity_stiffness(
    *,
    youngs_modulus: Array,
    poissons_ratio: Array,
    asperity_density: Array,
    asperity_radius: Array,
    roughness: Array,
) -> Array:
    """Factor between F_3/2 and asperity pressure, (4/3) E/(1 - nu^2) eta_a sqrt(R) sigma^1.5.

    Parameters
    ----------
    youngs_modulus : E of the softer body [Pa]
    poissons_ratio : nu of the softer body [-]
    asperity_density : eta_a [1/m^2]
    asperity_radius : R of the summits [m]
    roughness : composite root-mean-square roughness sigma [m]

    Returns
    -------
    contact pressure divided by F_3/2 [Pa]

    Notes
    -----
    Valid: one body rigid; elastic Gaussian summits of one radius, independent of each other.

    References
    ----------
    [Huang2017] eq. 9 (where the asperity density has the letter l), [GreenwoodWilliamson1966]

    Examples
    --------
    >>> k = asperity_stiffness(youngs_modulus=30e6, poissons_ratio=0.48, asperity_density=8e13,
    ...                        asperity_radius=1.5e-6, roughness=1e-6)
    >>> print(f"{k / 1e9:.3f} GPa")
    5.092 GPa
    """
    modulus = youngs_modulus / (1 - poissons_ratio * poissons_ratio)
    return (4 / 3) * modulus * asperity_density * asperity_radius**0.5 * roughness**1.5


@geometry
def asperity_pressure(
    *,
    film_ratio: Array,
    youngs_modulus: Array,
    poissons_ratio: Array,
    asperity_density: Array,
    asperity_radius: Array,
    roughness: Array,
) -> Array:
    """Mean contact pressure carried by asperities, `asperity_stiffness` times F_3/2(H).

    Parameters
    ----------
    film_ratio : H = h/sigma [-]
    youngs_modulus : E of the softer body [Pa]
    poissons_ratio : nu of the softer body [-]
    asperity_density : eta_a [1/m^2]
    asperity_radius : R of the summits [m]
    roughness : composite root-mean-square roughness sigma [m]

    Returns
    -------
    contact pressure [Pa]

    Notes
    -----
    Valid: real contact a small part of the nominal area.

    References
    ----------
    [Huang2017] eq. 9, [GreenwoodWilliamson1966]

    Examples
    --------
    >>> p = asperity_pressure(film_ratio=2.5, youngs_modulus=30e6, poissons_ratio=0.48,
    ...                       asperity_density=8e13, asperity_radius=1.5e-6, roughness=1e-6)
    >>> print(f"{p / 1e6:.5f} MPa")
    7.48565 MPa
    """
    stiffness = asperity_stiffness(
        youngs_modulus=youngs_modulus,
        poissons_ratio=poissons_ratio,
        asperity_density=asperity_density,
        asperity_radius=asperity_radius,
        roughness=roughness,
    )
    return stiffness * asperity_integral(film_ratio=film_ratio)


def film_ratio_under_contact(*, contact_pressure: Array, stiffness: Array) -> Array:
    """Film ratio at which asperities carry a contact pressure: the inverse of F_3/2.

    Newton's method on ln F_3/2, which is concave, so every start converges.

    Parameters
    ----------
    contact_pressure : [Pa]
    stiffness : of `asperity_stiffness` [Pa]

    Returns
    -------
    film ratio H [-]; NaN at contact pressure <= 0 or above 15 times the stiffness

    Notes
    -----
    Valid: H of -6 to 20.

    References
    ----------
    [derived] inverse of [GreenwoodWilliamson1966]

    Examples
    --------
    >>> print(f"{film_ratio_under_contact(contact_pressure=7.48565e6, stiffness=5.09242e9):.4f}")
    2.5000
    """
    valid = (real(contact_pressure) > 0) & (real(stiffness) > 0)
    valid = valid & (real(contact_pressure) <= _FLATTEST * real(stiffness))
    ratio = where(valid, contact_pressure, 1.0) / where(valid, stiffness, 1.0)
    xp = namespace(ratio)
    target = xp.log(ratio)
    light = real(target) < -0.844  # F_3/2(0) = 0.43
    thin = xp.sqrt(0.835 - 2 * (where(light, target, -0.844) + 0.844)) - 0.914
    film = where(light, thin, -(ratio ** (2 / 3)))
    for _ in range(6):  # five steps reach rounding for H -6 to 20; one more for a complex step
        bells = _bells(film)
        value, slope = _summed(bells, "3/2"), _summed(bells, "1/2")
        film = film + (xp.log(value) - target) * value / (1.5 * slope)
    return where(valid, film, math.nan)


def mean_gap_ratio(*, film_ratio: Array) -> Array:
    """Mean gap of two rough surfaces, h_T/sigma: the mean of max(H + z, 0) for normal z.

    H (1 + erf(H/sqrt 2))/2 + exp(-H^2/2)/sqrt(2 pi); tends to H for thick films.

    Parameters
    ----------
    film_ratio : H [-]

    Returns
    -------
    mean gap / composite roughness [-]

    Notes
    -----
    Valid: Gaussian surfaces.

    References
    ----------
    [Huang2017] eq. 6

    Examples
    --------
    >>> print(f"{mean_gap_ratio(film_ratio=1.5):.6f}")
    1.529307
    """
    xp = namespace(film_ratio)
    inside = (real(film_ratio) < _CERTAIN) & (real(film_ratio) > -_CERTAIN)
    safe = where(inside, film_ratio, 0.0)
    places, weights = (xp.asarray(part) for part in _gauss())
    scaled = xp.asarray(safe)[..., None] * places
    density = 1 / math.sqrt(2 * math.pi)
    half = density * safe * xp.sum(weights * xp.exp(-0.5 * scaled * scaled), axis=-1)
    rough = safe * (0.5 + half) + density * xp.exp(-0.5 * safe * safe)
    return where(inside, rough, where(real(film_ratio) > 0, film_ratio, 0.0))


def pressure_flow_factor(*, film_ratio: Array) -> Array:
    """Flow by a pressure gradient, relative to a smooth gap: phi_x = 1 - 0.90 e^(-0.56 H).

    Parameters
    ----------
    film_ratio : H [-]

    Returns
    -------
    phi_x [-]; below H = 0, the value at H = 0

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
    """Flow carried by the roughness, divided by (U/2) sigma: phi_s = (2 V - 1) Phi_s.

    Phi_s = 1.899 H^0.98 e^(-0.92 H + 0.05 H^2) to H = 5, 1.126 e^(-0.25 H) beyond. A rod
    of speed U drags along the flow (U/2)(h_T + sigma phi_s).

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
    """Mean of h/(local gap), phi_f: the shear stress by sliding, relative to a smooth gap.

    The roughness heights have the polynomial density of Patir and Cheng, which spans 3 sigma to
    either side; local gaps below sigma/100 are left out of the mean.

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
    """Correction of phi_f for the oil that roughness carries along, phi_fs = (2 V - 1) Phi_fs.

    Phi_fs = 11.1 H^2.31 e^(-2.38 H + 0.11 H^2) to H = 7, 0 beyond. The sliding shear of the rod
    is (eta U/h)(phi_f - phi_fs). A smooth rod has phi_f + Phi_fs.

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
    """Shear stress by a pressure gradient, relative to a smooth gap: phi_fp = 1 - 1.40 e^(-0.66 H).

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
