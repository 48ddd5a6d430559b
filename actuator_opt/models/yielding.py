"""Yield of a pre-stressed metal: von Mises, exact along the load path."""

from __future__ import annotations

from ..base.numeric import Array, namespace, real, where
from .strength_modes import Stress

_LEAST = 1e-9
"""Share of the strength that is always left: a metal that residual stress alone makes yield."""


def mises_product(*, first: Stress, second: Stress) -> Array:
    """Bilinear form of von Mises: the square of the equivalent stress for first = second.

    ((a1 - a2)(b1 - b2) + (a2 - a3)(b2 - b3) + (a3 - a1)(b3 - b1))/2 + 3 a12 b12.

    Parameters
    ----------
    first, second : stresses 1, 2, 3 and 12 [Pa]

    Returns
    -------
    product [Pa^2]

    Notes
    -----
    Valid: isotropic metals.

    References
    ----------
    [Shigley2011] distortion energy; [derived] polarised quadratic form

    Examples
    --------
    >>> pull = (300.0, 0.0, 0.0, 0.0)
    >>> mises_product(first=pull, second=pull) ** 0.5
    300.0
    """
    a1, a2, a3, a12 = first
    b1, b2, b3, b12 = second
    normal = (a1 - a2) * (b1 - b2) + (a2 - a3) * (b2 - b3) + (a3 - a1) * (b3 - b1)
    return normal / 2 + 3 * a12 * b12


def yield_utilisation(
    *, stress: Stress, yield_strength: Array, residual: Stress | None = None
) -> Array:
    """Utilisation 1/SR of a metal: von Mises of residual + SR stress reaches yield.

    With <a, b> of `mises_product` over yield^2:
    u = (<s, r> + sqrt(<s, r>^2 + (1 - <r, r>) <s, s>))/(1 - <r, r>).

    Parameters
    ----------
    stress : stresses 1, 2, 3 and 12 of the load [Pa]
    yield_strength : yield strength [Pa]
    residual : stresses that do not grow with the load [Pa]

    Returns
    -------
    utilisation [-]; very large where the residual stress alone reaches yield

    Notes
    -----
    Valid: isotropic metals, elastic until then.

    References
    ----------
    [Shigley2011] distortion energy; [derived] root of the quadratic in SR

    Examples
    --------
    >>> pull, press = (200.0, 0.0, 0.0, 0.0), (-100.0, 0.0, 0.0, 0.0)
    >>> print(f"{yield_utilisation(stress=pull, yield_strength=400.0, residual=press):.3f}")
    0.400
    """
    scale = 1 / (yield_strength * yield_strength)
    square = mises_product(first=stress, second=stress) * scale
    xp = namespace(square)
    if residual is None:
        return xp.sqrt(square)
    linear = mises_product(first=stress, second=residual) * scale
    left = 1 - mises_product(first=residual, second=residual) * scale
    left = where(real(left) > _LEAST, left, 0 * left + _LEAST)
    return (linear + xp.sqrt(linear * linear + left * square)) / left
