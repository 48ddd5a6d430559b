"""Fits of a secant damping over speed: values, bounds and verdicts, against certified answers."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from scipy.optimize import curve_fit, isotonic_regression

from actuator_opt.base import fitting as least_squares
from actuator_opt.base.errors import InputError
from actuator_opt.design.material import fit_double_exponential, fit_power_law

SPEEDS = np.linspace(0.5e-3, 10e-3, 20)
LAWS = (fit_power_law, fit_double_exponential)


def two_exponentials(v, a1, b1, a2, b2):
    """The law, written again."""
    return a1 * np.exp(b1 * v) + a2 * np.exp(b2 * v)


def test_power_law_meets_the_certified_answer():
    """Problem DanWood of the NIST reference data sets: values, standard errors, sum of squares."""
    x = [1.309, 1.471, 1.490, 1.565, 1.611, 1.680]
    y = [2.138, 3.421, 3.597, 4.340, 4.882, 5.660]
    fit = fit_power_law(x, y)
    a, b = fit.parameters["coefficient"], fit.parameters["exponent"]
    assert (a.value, b.value) == pytest.approx((7.6886226176e-01, 3.8604055871), rel=1e-8)
    certified = (1.8281973860e-02, 5.1726610913e-02)
    assert (a.standard_error, b.standard_error) == pytest.approx(certified, rel=1e-6)
    assert np.sum(fit.residuals**2) == pytest.approx(4.3173084083e-03, rel=1e-8)


def test_bounds_are_student_t():
    """Four spare points: the half-width of 95 % bounds is 2.776445 standard errors (tables)."""
    fit = fit_power_law([1.0, 2.0, 3.0, 4.0, 5.0, 6.0], [9.8, 5.2, 3.3, 2.4, 2.1, 1.6])
    for one in fit.parameters.values():
        assert (one.upper - one.value) / one.standard_error == pytest.approx(2.776445, rel=1e-6)
        assert one.upper - one.value == pytest.approx(one.value - one.lower)


@given(st.floats(0.2, 5e3), st.floats(-2.5, 1.5))
@settings(max_examples=15, deadline=None)
def test_power_law_returns_what_made_the_points(coefficient, exponent):
    """Points of a power law, falling or rising, give its parameters back; R-squared is 1."""
    fit = fit_power_law(SPEEDS, coefficient * SPEEDS**exponent)
    found = fit.values["coefficient"], fit.values["exponent"]
    assert found == pytest.approx((coefficient, exponent), rel=1e-6, abs=1e-8)
    assert fit.determined
    np.testing.assert_allclose(fit.predict(SPEEDS), coefficient * SPEEDS**exponent, rtol=1e-8)


@pytest.mark.parametrize(
    "made",
    [
        (3e5, -900.0, 1e5, -50.0),
        (1e6, -2500.0, 2e4, -5.0),
        (2e5, -300.0, 1e4, 80.0),
        (-2e5, -600.0, 4e5, -60.0),
    ],
)
def test_double_exponential_returns_what_made_the_points(made):
    """Rates of one sign or both, an amplitude below 0: the parameters come back, steepest first."""
    fit = fit_double_exponential(SPEEDS, two_exponentials(SPEEDS, *made))
    assert tuple(fit.values.values()) == pytest.approx(made, rel=1e-6)
    assert fit.determined
    assert fit.r_squared == pytest.approx(1.0, abs=1e-12)


def test_double_exponential_agrees_with_another_solver():
    """Scattered points: values and covariance of an ordinary Levenberg-Marquardt from the truth."""
    made = np.array([4e5, -700.0, 1.5e5, -60.0])
    truth = two_exponentials(SPEEDS, *made)
    points = truth * (1 + 0.005 * np.random.default_rng(3).standard_normal(SPEEDS.size))
    for weights in (None, 1 / truth**2):
        sigma = None if weights is None else weights**-0.5
        known, covariance = curve_fit(two_exponentials, SPEEDS, points, made, sigma=sigma)
        fit = fit_double_exponential(SPEEDS, points, weights)
        np.testing.assert_allclose(list(fit.values.values()), known, rtol=1e-5)
        errors = [one.standard_error for one in fit.parameters.values()]
        np.testing.assert_allclose(errors, np.sqrt(np.diag(covariance)), rtol=1e-3)
        middle, rate = SPEEDS[4], fit.predict(SPEEDS[4])
        lower, upper = fit.bounds(middle)
        slopes = [
            (two_exponentials(middle, *(known + step)) - two_exponentials(middle, *(known - step)))
            / (2e-5 * known[k])
            for k, step in enumerate(np.diag(1e-5 * known))
        ]
        half = 2.119905 * np.sqrt(np.array(slopes) @ covariance @ np.array(slopes))  # t of 16
        assert (upper - rate, rate - lower) == pytest.approx((half, half), rel=1e-3)


@pytest.mark.long
def test_bounds_hold_the_truth_as_often_as_they_say():
    """200 power laws with independent scatter: 95 % bounds of the exponent hold it 95 % of times.

    Ten misses of 200 are expected, with a standard deviation of 3.1.
    """
    random = np.random.default_rng(11)
    truth = 400.0 * SPEEDS**-1.1
    misses = 0
    for _ in range(200):
        points = truth * (1 + 0.03 * random.standard_normal(SPEEDS.size))
        one = fit_power_law(SPEEDS, points, 1 / truth**2).parameters["exponent"]
        misses += not one.lower <= -1.1 <= one.upper
    assert misses == pytest.approx(10, abs=7)


def test_r_squared_by_hand():
    """1 - SSE/SST of B, worked out here from the fitted values."""
    v, b = np.array([1.0, 2.0, 4.0, 8.0]), np.array([9.0, 5.0, 2.0, 1.5])
    fit = fit_power_law(v, b)
    made = fit.values["coefficient"] * v ** fit.values["exponent"]
    np.testing.assert_allclose(fit.residuals, b - made)
    assert fit.r_squared == pytest.approx(1 - np.sum((b - made) ** 2) / np.sum((b - b.mean()) ** 2))


def test_one_exponential_does_not_determine_two():
    """Points of one exponential: the curve is right, the verdict says the parameters are not."""
    points = 3e5 * np.exp(-100 * SPEEDS)
    fit = fit_double_exponential(SPEEDS, points)
    np.testing.assert_allclose(fit.predict(SPEEDS), points, rtol=1e-6)
    assert not fit.determined
    assert "of 4 parameters" in fit.doubts[0]
    open_ones = [one for one in fit.parameters.values() if np.isinf(one.upper)]
    assert open_ones
    assert not any(one.identifiable for one in open_ones)


def test_scattered_single_exponential_is_called_weak():
    """With 1 % scatter on one exponential, some bounds of two are wider than 30 %, and named."""
    scatter = 1 + 0.01 * np.random.default_rng(5).standard_normal(SPEEDS.size)
    fit = fit_double_exponential(SPEEDS, 3e5 * np.exp(-100 * SPEEDS) * scatter)
    assert not fit.determined
    weak = [name for name, one in fit.parameters.items() if not one.identifiable]
    assert weak
    assert any(name in fit.doubts[-1] for name in weak)


def test_exact_number_of_points_leaves_no_bounds():
    """As many points as parameters: fitted through them, infinite bounds, and the reason."""
    fit = fit_power_law([1e-3, 4e-3], [8e5, 2e5])
    assert fit.values["exponent"] == pytest.approx(-1.0)
    assert np.isinf(fit.parameters["exponent"].upper)
    lower, upper = fit.bounds(2e-3)
    assert (lower, upper) == (-np.inf, np.inf)
    assert fit.doubts == (
        "2 points for 2 parameters leave no degree of freedom, so errors are unknown",
    )


def test_constant_damping_has_exponent_zero_and_no_r_squared():
    """Equal points: b = 0 is known; R-squared, 0 over 0, is left out instead of made up."""
    fit = fit_power_law(SPEEDS, np.full(20, 3e5))
    assert fit.values["exponent"] == pytest.approx(0.0, abs=1e-9)
    assert fit.determined
    assert fit.r_squared is None


@pytest.mark.parametrize("exponent", [1.4e-16, -1e-12, 1e-6])
def test_nearly_constant_damping_is_determined(exponent):
    """An exponent next to 0 is as well known as any other: it is no missing parameter."""
    fit = fit_power_law(SPEEDS, SPEEDS**exponent)
    assert fit.values["exponent"] == pytest.approx(exponent, abs=1e-8)
    assert fit.determined


def test_exponential_towards_a_constant_is_determined():
    """A second rate of 0, B = a1 e^(b1 v) + constant, is found and known."""
    fit = fit_double_exponential(SPEEDS, 4e5 * np.exp(-800 * SPEEDS) + 6e4)
    made = (4e5, -800.0, 6e4, 0.0)
    assert tuple(fit.values.values()) == pytest.approx(made, rel=1e-6, abs=1e-4)
    assert fit.determined


def test_negative_points_are_fitted():
    """A B below 0, where friction drives, has no logarithm and is fitted all the same."""
    fit = fit_power_law([1.0, 2.0, 3.0], [2.0, 1.0, -0.1])
    assert 0 < fit.r_squared < 1


@pytest.mark.parametrize("law", LAWS)
def test_order_and_scale_do_not_matter(law):
    """Points shuffled, B in another unit, weights all doubled: the same curve."""
    points = 5e5 * np.exp(-600 * SPEEDS) + 300 / np.sqrt(SPEEDS)
    fit = law(SPEEDS, points)
    order = np.random.default_rng(0).permutation(SPEEDS.size)
    for other, unit in (
        (law(SPEEDS[order], points[order]), 1.0),
        (law(SPEEDS, 1e-6 * points), 1e-6),
        (law(SPEEDS, points, np.full(20, 2.0)), 1.0),
    ):
        np.testing.assert_allclose(other.predict(SPEEDS), unit * fit.predict(SPEEDS), rtol=1e-6)
        assert other.r_squared == pytest.approx(fit.r_squared, abs=1e-9)
    assert np.all(np.diff(fit.speed) > 0)


@pytest.mark.parametrize("law", LAWS)
def test_weights_count_points(law):
    """A point of weight 3 pulls as three points do."""
    points = 2e5 / (1 + 300 * SPEEDS)
    weights = np.ones(20)
    weights[4] = 3.0
    several = np.append(SPEEDS, [SPEEDS[4]] * 2), np.append(points, [points[4]] * 2)
    one, three = law(SPEEDS, points, weights), law(*several)
    np.testing.assert_allclose(one.predict(SPEEDS), three.predict(SPEEDS), rtol=1e-6)


@pytest.mark.parametrize("law", LAWS)
def test_gradient_vanishes_at_the_fit(law):
    """Least squares: residuals are orthogonal to the slope of the curve by every parameter."""
    points = 1.5e3 / SPEEDS + 1e4
    fit = law(SPEEDS, points)
    for name, value in fit.values.items():
        step = 1e-6 * value
        up = fit.law(speed=SPEEDS, **{**fit.values, name: value + step})
        down = fit.law(speed=SPEEDS, **{**fit.values, name: value - step})
        slope = (up - down) / (2 * step)
        cosine = slope @ fit.residuals / np.linalg.norm(slope) / np.linalg.norm(fit.residuals)
        assert abs(cosine) < 1e-5


def test_no_rising_curve_fits_a_falling_damping():
    """With a, b > 0 both laws rise: the best rising curve is the mean, so R-squared is at most 0.

    The mean by the pool-adjacent-violators algorithm, over all rising curves of any form.
    """
    falling = 1e3 / SPEEDS
    best = isotonic_regression(falling, increasing=True).x
    np.testing.assert_allclose(best, falling.mean())
    fit = fit_power_law(SPEEDS, falling)
    assert fit.values["exponent"] < 0
    assert fit.r_squared == pytest.approx(1.0)


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize(
    ("speed", "points", "weights", "said"),
    [
        ([0.0, 1.0, 2.0, 3.0, 4.0], [1.0] * 5, None, "speed of point 0 is 0; secant damping"),
        ([1.0, -2.0, 2.0, 3.0, 4.0], [1.0] * 5, None, "speed of point 1 is -2"),
        ([1.0, 2.0, 3.0, 4.0], [1.0, np.nan, 1.0, 1.0], None, "damping of point 1 is nan"),
        ([1.0, 2.0, np.inf, 4.0], [1.0] * 4, None, "speed of point 2 is inf"),
        ([1.0, 2.0, 3.0, 4.0], [1.0] * 4, [1.0, 0.0, 1.0, 1.0], "weight of point 1 is 0"),
        ([1.0, 2.0, 3.0], [1.0, 2.0], None, "shapes"),
        ([1.0], [1.0], None, "1 different speeds for a law with"),
        ([1.0] * 5, [1.0, 2.0, 3.0, 4.0, 5.0], None, "1 different speeds for a law with"),
        ([], [], None, "0 different speeds for a law with"),
    ],
)
def test_points_that_cannot_be_fitted_are_named(law, speed, points, weights, said):
    """Rest, negative speed, NaN, infinity, weight 0, unequal lengths, too few: one clear line."""
    with pytest.raises(InputError, match=said) as error:
        law(speed, points, weights)
    assert "\n" not in str(error.value)
    assert error.value.diagnostics[0].remedy


def test_least_squares_starts_inside_its_bounds_and_keeps_to_them():
    """A start outside is moved in; the minimum of (x - 3)^2 + (y - 1)^2 with x <= 2 is (2, 1)."""
    asked = []

    def residuals(x):
        asked.append(x.copy())
        return x - np.array([3.0, 1.0])

    low, high = np.array([-np.inf, 0.0]), np.array([2.0, np.inf])
    found = least_squares.solve(
        residuals,
        np.array([5.0, -1.0]),
        (low, high),
        slopes=lambda _: np.eye(2),
        sizes="jac",
        room=1e-3,
    )
    assert found.x == pytest.approx([2.0, 1.0], abs=1e-6)
    assert found.cost == pytest.approx(0.5, rel=1e-6)
    assert asked[0] == pytest.approx([2.0 - 1e-3, 1e-3])
    assert all(((low <= x) & (x <= high)).all() for x in asked)
