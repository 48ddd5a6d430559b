"""Roots of many cubics at once: safeguarded Newton steps, then the remaining quadratic."""

from __future__ import annotations

import numpy as np

BEYOND = 1.324718
"""Root of x^3 = x + 1: scales the distance to a start point beyond all roots but one."""

SHY = 1 + 1e-15
"""Divisor of a Newton step: keeps it on its side of the root despite rounding."""

MOST = 120
"""Number of steps for a triple root: each step covers a third of the distance."""


def cubic_roots(square: np.ndarray, slope: np.ndarray, constant: np.ndarray) -> np.ndarray:
    """All roots of x^3 + square x^2 + slope x + constant, (..., 3) complex, the real root first.

    Newton's steps start beyond the outer real root and approach it from one side. The remaining
    quadratic is divided out from the end that loses fewest digits [Kahan1986].

    Parameters
    ----------
    square, slope, constant : real coefficients, finite, of one shape

    Examples
    --------
    >>> roots = cubic_roots(np.array([-6.0]), np.array([11.0]), np.array([-6.0]))
    >>> print(np.sort(roots.real.round(12)))
    [[1. 2. 3.]]
    """
    x = _outer_root(square, slope, constant)
    with np.errstate(all="ignore"):
        last = -constant / x
        far = np.abs(x) * x * x > np.abs(constant)
    linear = np.where(far, (last - slope) / np.where(far, x, 1.0), x + square)
    last = np.where(far, last, (x + square) * x + slope)
    half = -0.5 * linear
    rest = half * half - last
    apart = np.sqrt(np.abs(rest))
    larger = half + np.copysign(apart, half)
    smaller = np.divide(last, larger, out=np.zeros_like(last), where=larger != 0)
    real = rest >= 0
    found = np.empty((*x.shape, 3), dtype=complex)
    found[..., 0] = x
    found[..., 1].real, found[..., 1].imag = (
        np.where(real, larger, half),
        np.where(real, 0.0, apart),
    )
    found[..., 2].real, found[..., 2].imag = np.where(real, smaller, half), -found[..., 1].imag
    return found


def _outer_root(square: np.ndarray, slope: np.ndarray, constant: np.ndarray) -> np.ndarray:
    """A real root of each cubic: the outer root on the far side of the inflection point.

    At a triple root, slope and value are rounding errors only: no step passes the inflection.
    """
    x = inflection = square * (-1 / 3)
    value, rise = _value(x, square, slope, constant)
    distance, falls = np.cbrt(np.abs(value)), np.sqrt(np.maximum(-rise, 0.0))
    distance = np.where(falls > 0, BEYOND * np.maximum(distance, falls), distance)
    side = np.copysign(1.0, value)
    following = x - side * distance
    going = following != x
    for _ in range(MOST):
        x = np.where(going, following, x)
        value, rise = _value(x, square, slope, constant)
        with np.errstate(all="ignore"):
            following = x - value / rise / SHY
        following = np.where(side * (following - inflection) > 0, inflection, following)
        going &= side * (following - x) > 0
        if not going.any():
            break
    return x


def _value(
    x: np.ndarray, square: np.ndarray, slope: np.ndarray, constant: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Value and slope of the cubics."""
    first = x + square
    second = first * x + slope
    return second * x + constant, (x + first) * x + second
