"""Real polynomials in s as tuples of coefficients, lowest power first.

Coefficients are floats or arrays that broadcast. Terms with a coefficient that is the number 0 are
skipped, so one formula serves circuits with and without a line or a valve. Everything but `roots`
is plain arithmetic and works under a complex step. So that a complex step can pass through
frequency responses too, their real and imaginary parts are kept separately.
"""

from __future__ import annotations

from typing import NamedTuple, TypeAlias

import numpy as np

from .numeric import Array, namespace, real

BEYOND = 1.324718
"""Root of x^3 = x + 1. An estimate of the outer root's distance from the inflection point is
multiplied by this number, so that Newton's steps start beyond the root."""
SHY = 1 + 1e-15
"""Divisor that shortens a Newton step, so that rounding does not carry it past the root."""
MOST = 120
"""Largest number of Newton steps: enough for a triple root, where each step covers a third of the
remaining distance."""


def cubic_roots(square: np.ndarray, slope: np.ndarray, constant: np.ndarray) -> np.ndarray:
    """All roots of x^3 + square x^2 + slope x + constant, (..., 3) complex, the real root first.

    Newton's steps start beyond the outer real root and approach it from one side. The remaining
    quadratic is found by synthetic division, from the highest or from the lowest power, whichever
    loses fewer digits [Kahan1986].

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
        product = -constant / x
        far = np.abs(x) * x * x > np.abs(constant)
    linear = np.where(far, (product - slope) / np.where(far, x, 1.0), x + square)
    product = np.where(far, product, (x + square) * x + slope)
    half = -0.5 * linear
    discriminant = half * half - product
    offset = np.sqrt(np.abs(discriminant))
    larger = half + np.copysign(offset, half)
    smaller = np.divide(product, larger, out=np.zeros_like(product), where=larger != 0)
    real = discriminant >= 0
    result = np.empty((*x.shape, 3), dtype=complex)
    result[..., 0] = x
    result[..., 1].real, result[..., 1].imag = (
        np.where(real, larger, half),
        np.where(real, 0.0, offset),
    )
    result[..., 2].real, result[..., 2].imag = np.where(real, smaller, half), -result[..., 1].imag
    return result


def _outer_root(square: np.ndarray, slope: np.ndarray, constant: np.ndarray) -> np.ndarray:
    """The outermost real root of each cubic, found by Newton's steps from beyond it.

    At a triple root, the computed slope and value are only rounding errors, so the steps stop at
    the inflection point.
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


Polynomial: TypeAlias = tuple[Array, ...]
"""Coefficients, lowest power first; () is zero."""


class Parts(NamedTuple):
    """A complex number as two separate parts, each of which may carry a complex step."""

    real: Array
    imaginary: Array

    @property
    def complex(self) -> Array:
        """Both parts as one complex number; correct only if no part carries a complex step."""
        return self.real + 1j * self.imaginary


def _vanishes(coefficient: Array) -> bool:
    return isinstance(coefficient, (int, float)) and coefficient == 0


def trimmed(polynomial: Polynomial) -> Polynomial:
    """Drop coefficients of the highest powers that are the number 0."""
    size = len(polynomial)
    while size and _vanishes(polynomial[size - 1]):
        size -= 1
    return polynomial[:size]


def add(*polynomials: Polynomial) -> Polynomial:
    """Sum of polynomials.

    >>> add((1.0, 2.0), (3.0,))
    (4.0, 2.0)
    """
    total: list[Array] = [0.0] * max(len(p) for p in polynomials)
    for polynomial in polynomials:
        for power, coefficient in enumerate(polynomial):
            if not _vanishes(coefficient):
                known = total[power]
                total[power] = coefficient if _vanishes(known) else known + coefficient
    return trimmed(tuple(total))


def multiply(*factors: Polynomial) -> Polynomial:
    """Product of polynomials.

    >>> multiply((1.0, 1.0), (1.0, -1.0))
    (1.0, 0.0, -1.0)
    """
    product: Polynomial = factors[0]
    for factor in factors[1:]:
        nonzero = [(j, c) for j, c in enumerate(factor) if not _vanishes(c)]
        terms: list[Array] = [0.0] * max(len(product) + len(factor) - 1, 0)
        filled = [False] * len(terms)
        for i, first in enumerate(product):
            if _vanishes(first):
                continue
            for j, second in nonzero:
                term, k = first * second, i + j
                terms[k] = terms[k] + term if filled[k] else term
                filled[k] = True
        product = tuple(terms)
    return trimmed(product)


def scale(polynomial: Polynomial, factor: Array) -> Polynomial:
    """Product of a polynomial and a number."""
    return multiply(polynomial, (factor,))


def at_frequency(polynomial: Polynomial, angular_frequency: Array) -> Parts:
    """Value at s = i omega, by Horner's scheme in omega^2 for each part.

    >>> at_frequency((1.0, 2.0, 3.0), 2.0)
    Parts(real=-11.0, imaginary=4.0)
    """
    square = -angular_frequency * angular_frequency
    parts = []
    for start in (0, 1):
        value: Array = 0.0
        for coefficient in reversed(polynomial[start::2]):
            value = value * square + coefficient
        parts.append(value)
    return Parts(parts[0], parts[1] * angular_frequency)


def at_point(polynomial: Polynomial, point: Parts) -> Parts:
    """Value at a complex point, by Horner's scheme.

    >>> at_point((1.0, 2.0, 3.0), Parts(0.0, 2.0))
    Parts(real=-11.0, imaginary=4.0)
    """
    x, y = point
    along: Array = 0.0
    across: Array = 0.0
    for coefficient in reversed(polynomial):
        along, across = along * x - across * y + coefficient, along * y + across * x
    return Parts(along, across)


def even_and_odd(polynomial: Polynomial) -> tuple[Polynomial, Polynomial]:
    """Split P(i omega) = E(w) + i omega O(w) into polynomials E and O in w = omega^2."""
    signs = (1.0, -1.0)
    even = tuple(signs[k % 2] * c for k, c in enumerate(polynomial[0::2]))
    odd = tuple(signs[k % 2] * c for k, c in enumerate(polynomial[1::2]))
    return trimmed(even), trimmed(odd)


def square_of_magnitude(polynomial: Polynomial) -> Polynomial:
    """|P(i omega)|^2 = E^2 + w O^2, as a polynomial in w = omega^2 (see `even_and_odd`).

    >>> square_of_magnitude((1.0, 2.0))
    (1.0, 4.0)
    """
    even, odd = even_and_odd(polynomial)
    return add(multiply(even, even), multiply((0.0, 1.0), odd, odd))


def roots(polynomial: Polynomial) -> np.ndarray:
    """All roots, (..., degree) complex: by formula for cubics, else companion-matrix eigenvalues.

    Only real parts of the coefficients are used. Equal neighbours along the last axis (copies of
    one design for complex steps) are solved only once. A zero leading coefficient in an array gives
    a root at minus infinity; coefficients that are not finite make every root NaN.
    """
    if len(polynomial) < 2:
        shape = np.shape(real(polynomial[0])) if polynomial else ()
        return np.empty((*shape, 0), dtype=complex)
    rows = np.broadcast_arrays(*[np.asarray(real(c), dtype=float) for c in polynomial])
    coefficients = np.stack(rows, axis=-1)
    shape = coefficients.shape[:-1]
    if not shape or shape[-1] < 2:
        return _scaled_roots(coefficients)
    other = coefficients[..., 1:, :] != coefficients[..., :-1, :]
    new = np.concatenate([[True], other.any(axis=(*range(len(shape) - 1), -1))])
    if new.all():
        return _scaled_roots(coefficients)
    return _scaled_roots(coefficients[..., new, :])[..., np.cumsum(new) - 1, :]


def _scaled_roots(coefficients: np.ndarray) -> np.ndarray:
    """Roots of polynomials (..., degree + 1), computed with roots scaled to mean magnitude 1."""
    degree = coefficients.shape[-1] - 1
    lead = coefficients[..., -1]
    with np.errstate(all="ignore"):
        size = np.abs(coefficients[..., 0] / lead) ** (1 / degree)
        size = np.where(np.isfinite(size) & (size > 0), size, 1.0)
        monic = coefficients[..., :-1] / lead[..., None]
        monic = monic * size[..., None] ** (np.arange(degree) - degree)
    broken = ~np.all(np.isfinite(monic), axis=-1)
    monic = np.where(broken[..., None], 0.0, monic)
    if degree == 3:
        result = cubic_roots(monic[..., 2], monic[..., 1], monic[..., 0])
    else:
        companion = np.zeros((*monic.shape[:-1], degree, degree))
        companion[..., 1:, :-1] = np.eye(degree - 1)
        companion[..., :, -1] = -monic
        result = np.linalg.eigvals(companion).astype(complex)
    result *= size[..., None]
    result = np.where(broken[..., None], np.nan, result)
    lower = (lead == 0) & np.all(np.isfinite(coefficients), axis=-1)
    if lower.any():
        result[lower, 0] = -np.inf
        if degree > 1:
            result[lower, 1:] = _scaled_roots(coefficients[lower, :-1])
    return result


def root_parts(polynomial: Polynomial) -> Parts:
    """Real and imaginary parts of all roots, each (..., degree); see `roots`."""
    if len(polynomial) > 1:
        recorded = getattr(namespace(*polynomial), "root_parts", None)
        if recorded is not None:
            return Parts(*recorded([real(coefficient) for coefficient in polynomial]))
    found = roots(polynomial)
    return Parts(found.real, found.imag)


def moved_root(polynomial: Polynomial, root: Parts) -> Parts:
    """A simple (not multiple) root; its complex step follows from those of the coefficients.

    The root moves by -dP(root)/P'(root), with the complex step dP of the polynomial's value.
    """
    x, y = root
    value = at_point(polynomial, root)
    slope = at_point(tuple(k * real(c) for k, c in enumerate(polynomial))[1:], root)
    across, along = value.real - real(value.real), value.imaginary - real(value.imaginary)
    size = slope.real * slope.real + slope.imaginary * slope.imaginary
    return Parts(
        x - (across * slope.real + along * slope.imaginary) / size,
        y - (along * slope.real - across * slope.imaginary) / size,
    )


def positive_root(polynomial: Polynomial, start: Array) -> Array:
    """A real root near `start`, refined by Newton's method, with its derivative as complex step.

    Only the last Newton step keeps the complex steps of the coefficients; by the implicit-function
    theorem, this gives the root its exact derivative. For a constant, which has no root, `start` is
    returned.
    """
    value = start
    if len(polynomial) < 2:
        return value
    for last in (False, False, True):
        result: Array = 0.0
        slope: Array = 0.0
        for power in range(len(polynomial) - 1, -1, -1):
            coefficient = polynomial[power] if last else real(polynomial[power])
            result = result * value + coefficient
            if power:
                slope = slope * value + power * coefficient
        value = value - result / slope
    return value
