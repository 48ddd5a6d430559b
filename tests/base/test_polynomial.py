"""Claims about polynomials in s: arithmetic, responses, roots and their motion."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, strategies as st
from numpy.polynomial import polynomial as reference

from actuator_opt.base import polynomial

COEFFICIENT = st.floats(-1e3, 1e3).filter(lambda value: value == 0 or abs(value) > 1e-3)
POLYNOMIAL = st.lists(COEFFICIENT, min_size=1, max_size=7).map(tuple)
STEP = 1e-30


def padded(coefficients):
    """At least one coefficient, as NumPy's polynomials want."""
    return np.array([*coefficients, 0.0])


@given(POLYNOMIAL, POLYNOMIAL, POLYNOMIAL)
def test_sums_and_products_are_those_of_numpy(first, second, third):
    """Sum, product and multiple by an independent library; leading zeros are gone."""
    total = polynomial.add(first, second, third)
    expected = reference.polyadd(reference.polyadd(first, second), third)
    np.testing.assert_allclose(reference.polysub(padded(total), expected), 0, atol=1e-9)
    product = polynomial.multiply(first, second, third)
    expected = reference.polymul(reference.polymul(first, second), third)
    np.testing.assert_allclose(reference.polysub(padded(product), expected), 0, atol=1e-4)
    np.testing.assert_allclose(padded(polynomial.scale(first, 2.5))[:1], 2.5 * first[0], rtol=1e-15)
    assert not total or total[-1] != 0
    assert not product or product[-1] != 0


def test_zero_is_empty_and_costs_nothing():
    """The number 0 vanishes; an array of zeros is data and stays."""
    assert polynomial.add((1.0,), (-1.0, 0.0)) == ()
    assert polynomial.multiply((), (1.0, 2.0)) == ()
    assert polynomial.multiply((0.0, 1.0), ()) == ()
    assert polynomial.trimmed((1, 0, 0.0)) == (1,)
    assert len(polynomial.trimmed((1.0, np.zeros(2)))) == 2


@given(POLYNOMIAL, st.floats(1e-2, 1e2))
def test_frequency_response_in_two_parts(coefficients, omega):
    """Both parts, the squared magnitude and E + i w O equal complex arithmetic."""
    expected = reference.polyval(1j * omega, coefficients)
    size = np.sum(np.abs(coefficients) * omega ** np.arange(len(coefficients)))
    parts = polynomial.at_frequency(coefficients, omega)
    assert abs(complex(parts.real, parts.imaginary) - expected) <= 1e-13 * size
    square = reference.polyval(omega**2, padded(polynomial.square_of_magnitude(coefficients)))
    assert square == pytest.approx(abs(expected) ** 2, rel=1e-11, abs=1e-12 * size**2)
    even, odd = (
        reference.polyval(omega**2, padded(p)) for p in polynomial.even_and_odd(coefficients)
    )
    assert abs(even + 1j * omega * odd - expected) <= 1e-13 * size


def of_roots(roots, lead=1.0):
    """Coefficients of a polynomial by its roots."""
    return tuple(lead * reference.polyfromroots(roots).real)


@pytest.mark.parametrize("scale", [1e-12, 1.0, 1e12])
def test_roots_over_many_magnitudes(scale):
    """A leakage pole, an oil pair and a line pair, five decades apart, in any unit of time."""
    expected = scale * np.array([-1e-2, -3 + 800j, -3 - 800j, -50 + 9e3j, -50 - 9e3j, -2e4])
    found = polynomial.roots(of_roots(expected, 1e-40))
    for root in expected:
        assert np.min(np.abs(found - root)) <= 1e-9 * abs(root)


def test_repeated_roots_come_to_half_the_digits():
    """A double root is found to the square root of rounding, the best any method in doubles can."""
    found = polynomial.roots(of_roots([-5.0, -5.0, -90.0]))
    np.testing.assert_allclose(np.sort(found.real), [-90, -5, -5], rtol=1e-6)


def test_roots_of_arrays_are_those_of_each_column():
    """Batches, repeated columns, and columns that lose their leading coefficient."""
    columns = [of_roots([-1.0, -2.0, -k]) for k in (3.0, 4.0, 4.0)]
    found = polynomial.roots(tuple(np.array(columns).T))
    np.testing.assert_allclose(np.sort(found.real)[:, 0], [-3, -4, -4], rtol=1e-12)
    same = polynomial.roots(tuple(np.array([columns[0]] * 5).T))
    np.testing.assert_allclose(same, np.broadcast_to(same[:1], (5, 3)))
    lower = polynomial.roots((np.array([2.0, 6.0]), np.array([3.0, 5.0]), np.array([1.0, 0.0])))
    np.testing.assert_allclose(np.sort(lower[0].real), [-2, -1], rtol=1e-12)
    np.testing.assert_allclose(np.sort(lower[1].real), [-np.inf, -1.2], rtol=1e-12)


def test_roots_without_an_answer():
    """Constants have none; a coefficient that is no number makes every root of its column NaN."""
    assert polynomial.roots(()).shape == (0,)
    assert polynomial.roots((np.ones(3),)).shape == (3, 0)
    found = polynomial.roots((np.array([1.0, np.nan]), np.array([2.0, 1.0]), 1.0))
    np.testing.assert_array_equal(np.isnan(found), [[False, False], [True, True]])
    assert np.isnan(polynomial.roots((1.0, np.inf, 1.0))).all()


def test_roots_move_as_the_differences_say():
    """Motion of a simple root and of a polished real root against central differences."""
    base = np.array(of_roots([-3 + 20j, -3 - 20j, -7.0, 4.0]))
    for k in range(5):
        stepped = tuple(base + 1j * STEP * (np.arange(5) == k))
        change = 1e-5 * abs(base[k]) * (np.arange(5) == k)
        for near in (-3 + 20j, -7.0):
            high, low, root = (
                min(polynomial.roots(tuple(c)), key=lambda r: abs(r - near))
                for c in (base + change, base - change, base)
            )
            slope = (high - low) / (2e-5 * abs(base[k]))
            moving = polynomial.moved_root(stepped, polynomial.Parts(root.real, root.imag))
            found = (np.imag(moving.real) + 1j * np.imag(moving.imaginary)) / STEP
            assert abs(found - slope) <= 1e-6 * abs(slope)
        polished = polynomial.positive_root(stepped, 4.001)
        assert polished.real == pytest.approx(4.0, rel=1e-12)
        moved = (
            polynomial.positive_root(tuple(base + change), 4.0)
            - polynomial.positive_root(tuple(base - change), 4.0)
        ) / (2e-5 * abs(base[k]))
        assert polished.imag / STEP == pytest.approx(moved, rel=1e-6)
    assert polynomial.positive_root((3.0,), 1.0) == 1.0


def test_roots_of_a_cubic_far_apart_keep_their_digits():
    """A real root of -1e8 beside a lightly damped pair: damping ratio to 1e-13, size to 1e-15."""
    far, size, damping = 1e8, 2.0**10, 2.0**-6  # (s + far) (s^2 + 2 damping size s + size^2)
    pair = (size**2, 2 * damping * size, 1.0)
    found = polynomial.roots(polynomial.multiply((far, 1.0), pair))
    order = np.argsort(np.abs(found))
    assert found[order[2]] == pytest.approx(-far, rel=1e-15)
    one, two = found[order[:2]]
    assert one == np.conj(two)
    assert abs(one) == pytest.approx(size, rel=1e-14)
    assert -one.real / abs(one) == pytest.approx(damping, rel=1e-9)  # the products round at 1e8


CUBIC = st.floats(-1e4, 1e4).filter(lambda value: value == 0 or abs(value) > 1e-4)


@given(st.lists(st.tuples(CUBIC, CUBIC, CUBIC), min_size=1, max_size=5))
def test_cubics_are_zero_at_their_roots(rows):
    """Sum, pair products and product of the roots are the coefficients, to their rounding."""
    square, slope, constant = np.array(rows).T
    found = polynomial.roots((constant, slope, square, 1.0))
    x, y, z = np.moveaxis(found, -1, 0)
    size = np.abs(found).max(axis=-1)
    assert (np.abs(x + y + z + square) <= 1e-14 * (size + np.abs(square))).all()
    assert (np.abs(x * y + y * z + z * x - slope) <= 1e-13 * size**2 + 1e-300).all()
    assert (np.abs(x * y * z + constant) <= 1e-13 * size**3 + 1e-300).all()
    assert (found.imag.sum(axis=-1) == 0).all()


@pytest.mark.parametrize("apart", [0.0, 1e-12, 1e-8, 1e-4])
def test_roots_of_a_cubic_all_but_in_one_place(apart):
    """Where its slope is rounding alone the roots still make the coefficients."""
    random = np.random.default_rng(0)
    near = 1 + apart * random.normal(size=(3, 50_000))
    x, y, z = near * 10 ** random.uniform(-3, 3, 50_000)
    square, slope, constant = -(x + y + z), x * y + y * z + z * x, -x * y * z
    x, y, z = np.moveaxis(polynomial.roots((constant, slope, square, np.ones(50_000))), -1, 0)
    np.testing.assert_allclose(-(x + y + z), square, rtol=1e-14)
    np.testing.assert_allclose(x * y + y * z + z * x, slope, rtol=1e-14)
    np.testing.assert_allclose(-x * y * z, constant, rtol=1e-14)


@pytest.mark.parametrize("root", [-3.0, 0.0, 1e-5, 7e6])
def test_multiple_roots_of_a_cubic(root):
    """Three roots in one place, and two beside another, as far as their rounding allows."""
    one = (-root, 1.0)
    found = polynomial.roots(polynomial.multiply(one, one, one))
    np.testing.assert_allclose(found, root, rtol=3e-5, atol=1e-12)
    other = (-5 * root - 1, 1.0)
    found = np.sort(polynomial.roots(polynomial.multiply(one, one, other)).real)
    np.testing.assert_allclose(found, sorted([root, root, 5 * root + 1]), rtol=1e-6, atol=1e-7)
