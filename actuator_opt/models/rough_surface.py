"""Two rough surfaces pressed together: asperity contact and the mean gap between them.

The film ratio is H = h/sigma: the distance of the mean planes over the composite roughness of a
Gaussian surface. `flow_factors` gives the effect of the same roughness on a flow.
"""

from __future__ import annotations

import math

import numpy as np

from ..base.numeric import Array, geometry, magnitude, namespace, real, where

_STEP = 0.15
_HEIGHTS = tuple((_STEP * i) ** 2 for i in range(29))
"""Squares of the nodes of a trapezium sum: exact to 1e-11 for film ratios of -6 to 20."""
_ORDERS = {"-1/2": 0, "1/2": 2, "3/2": 4, "5/2": 6}
"""Order n of an asperity integral as the even power 2n + 1 under its sum."""
_WEIGHTS = {
    order: tuple(
        2 * _STEP / math.sqrt(2 * math.pi) * (0.5 if s == 0 else 1) * s ** (power / 2)
        for s in _HEIGHTS
    )
    for order, power in _ORDERS.items()
}
"""Weights of the trapezium sum at each height, by order."""
_PLACES, _SHARES = (tuple(part.tolist()) for part in np.polynomial.legendre.leggauss(32))
"""Nodes and weights of Gauss and Legendre on -1 to 1."""
_FLATTEST = 15.0
"""F_3/2 at about H = -6, where the sum for the asperity integral ends."""
_CERTAIN = 8.5
"""Film ratio beyond which the normal distribution is 0 or 1 to double precision."""


def _bells(value: Array) -> Array:
    """exp(-(value + height)^2/2) at every summit height of the sum, on a new last axis."""
    xp = namespace(value)
    column = xp.asarray(value)[..., None] + xp.asarray(_HEIGHTS)
    return xp.exp(-0.5 * column * column)


def _summed(bells: Array, order: str) -> Array:
    """The asperity integral of an order from the bells at its film ratio."""
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
    """Factor of the asperity contact pressure, (4/3) E/(1 - nu^2) eta_a sqrt(R) sigma^1.5.

    Parameters
    ----------
    youngs_modulus : E of the softer body [Pa]
    poissons_ratio : nu of the softer body [-]
    asperity_density : eta_a [1/m^2]
    asperity_radius : R of the summits [m]
    roughness : composite root-mean-square roughness sigma [m]

    Returns
    -------
    contact pressure over F_3/2 [Pa]

    Notes
    -----
    Valid: one body rigid; Gaussian summits of one radius, elastic, each by itself.

    References
    ----------
    [Huang2017] eq. 9 (asperity density printed l), [GreenwoodWilliamson1966]

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
    for _ in range(6):  # five reach rounding from -6 to 20, one more a complex step
        bells = _bells(film)
        value, slope = _summed(bells, "3/2"), _summed(bells, "1/2")
        film = film + (xp.log(value) - target) * value / (1.5 * slope)
    return where(valid, film, math.nan)


def mean_gap_ratio(*, film_ratio: Array) -> Array:
    """Mean gap of two rough surfaces over sigma, h_T/sigma = E max(H + z, 0), z normal.

    H (1 + erf(H/sqrt 2))/2 + exp(-H^2/2)/sqrt(2 pi); tends to H for thick films.

    Parameters
    ----------
    film_ratio : H [-]

    Returns
    -------
    mean gap over the composite roughness [-]

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
    places = xp.asarray([0.5 * (place + 1) for place in _PLACES])
    weights = xp.asarray([0.5 * share for share in _SHARES])
    scaled = xp.asarray(safe)[..., None] * places
    density = 1 / math.sqrt(2 * math.pi)
    half = density * safe * xp.sum(weights * xp.exp(-0.5 * scaled * scaled), axis=-1)
    rough = safe * (0.5 + half) + density * xp.exp(-0.5 * safe * safe)
    return where(inside, rough, where(real(film_ratio) > 0, film_ratio, 0.0))
