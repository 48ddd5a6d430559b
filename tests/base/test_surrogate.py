"""The Chebyshev surrogate: exact for polynomials, its own derivative, points without answers."""

import numpy as np
import pytest
from hypothesis import given, strategies as st

from actuator_opt.base.numeric import STEP
from actuator_opt.base.surrogate import Interpolation, SurrogateAxis, surrogate

AXES = (SurrogateAxis("speed", 1e-3, 1.0, 5), SurrogateAxis("pressure", 1e5, 4e7, 4))
BASE = {"speed": 0.1, "pressure": 1e6, "modulus": 8e6}


def smooth(point):
    """A polynomial of degree 4 x 3 in the logarithms, times a power of the modulus."""
    u, p = np.log(point["speed"]), np.log(point["pressure"])
    scale = (point["modulus"] / 8e6) ** 0.5
    values = scale * np.array([1 + u**4 - p**3 * u, 2 - u * p])
    return Interpolation(values, {"modulus": 0.5 * values, "speed": values, "pressure": values})


@given(st.floats(1e-3, 1.0), st.floats(1e5, 4e7))
def test_polynomials_are_met_exactly(speed, pressure):
    """Where the function is a polynomial of the axes' degrees, the surrogate is the function."""
    fitted = surrogate(smooth, base=BASE, axes=AXES)
    found = fitted({"speed": speed, "pressure": pressure})
    wanted = smooth({"speed": speed, "pressure": pressure, "modulus": 8e6}).values
    assert found == pytest.approx(wanted, rel=1e-9, abs=1e-6 * max(abs(wanted)))


def test_other_inputs_enter_to_the_first_order():
    """A change of 1 % in an input that is no axis is met to 1 in 10^4 of the value."""
    fitted = surrogate(smooth, base=BASE, axes=AXES)
    assert fitted.linear == ("modulus",)
    point = {"speed": 0.02, "pressure": 3e6, "modulus": 8.08e6}
    assert fitted(point) == pytest.approx(smooth(point).values, rel=1e-4)


def test_arrays_and_complex_steps_pass_through():
    """Inputs broadcast; the imaginary part over the step is the slope, zero beyond the box."""
    fitted = surrogate(smooth, base=BASE, axes=AXES)
    speeds = np.array([[0.01], [0.5]])
    found = fitted({"speed": speeds, "pressure": np.array([1e6, 2e6, 3e6])})
    assert found.shape == (2, 2, 3)
    one = fitted({"speed": 0.5, "pressure": 2e6})
    assert found[:, 1, 1] == pytest.approx(one, rel=1e-12)
    slope = fitted({"speed": 0.05 + 1j * STEP, "pressure": 2e6}).imag / STEP
    near = [fitted({"speed": 0.05 * (1 + h), "pressure": 2e6}) for h in (1e-5, -1e-5)]
    assert slope == pytest.approx((near[0] - near[1]) / (2e-5 * 0.05), rel=1e-6)
    beyond = fitted({"speed": 7.0 + 1j * STEP, "pressure": 2e6})
    assert beyond.imag == pytest.approx(np.zeros(2))
    assert beyond.real == pytest.approx(fitted({"speed": 1.0, "pressure": 2e6}))
    assert not fitted.covers({"speed": 7.0})
    assert fitted.covers({"speed": 0.5})


def test_points_without_an_answer_are_left_out():
    """One point in twenty missing: said, and the rest still met; three missing: refused."""

    def gaps(count):
        seen = []

        def function(point):
            seen.append(point)
            if len(seen) <= count:
                return Interpolation(np.zeros(2), {}, why="did not converge")
            return smooth(point)

        return surrogate(function, base=BASE, axes=AXES)

    one = gaps(1)
    assert one.failed == ("did not converge",)
    assert gaps(3) is None


def test_neighbours_follow_each_other():
    """Only one node index changes from one call to the next, by one."""
    seen = []

    def function(point):
        seen.append([AXES[i].points.index(point[AXES[i].name]) for i in range(2)])
        return smooth(point)

    surrogate(function, base=BASE, axes=AXES)
    steps = np.abs(np.diff(np.array(seen), axis=0)).sum(axis=1)
    assert (steps == 1).all()


def test_without_axes_it_is_the_base():
    """No extent at all: the base value and the first order around it."""
    fitted = surrogate(smooth, base=BASE, axes=())
    assert fitted({}) == pytest.approx(smooth(BASE).values)
    assert set(fitted.linear) == {"speed", "pressure", "modulus"}


def test_slopes_are_met_too():
    """With the function's own slopes two nodes along an axis make a cubic, and so its slope.

    exp(u/3) over u = ln v, a factor 1.25 to either side: the error of a cubic is below 1e-5.
    """

    def wave(point):
        value = np.array([np.exp(np.log(point["speed"]) / 3)])
        return Interpolation(value, {"speed": value / 3})

    axis = SurrogateAxis("speed", 0.08, 0.125, 2, hermite=True)
    fitted = surrogate(wave, base={"speed": 0.1}, axes=(axis,))
    for speed in (0.08, 0.0913, 0.1, 0.12):
        assert fitted({"speed": speed})[0] == pytest.approx(speed ** (1 / 3), rel=1e-5)
        slope = fitted({"speed": speed}, slope="speed")[0]
        assert slope == pytest.approx(speed ** (1 / 3) / 3, rel=1e-3)


def test_slope_along_an_axis_is_the_derivative():
    """The derivative by the logarithm of an axis equals the complex step's."""
    fitted = surrogate(smooth, base=BASE, axes=AXES)
    point = {"speed": 0.05, "pressure": 2e6}
    stepped = fitted({**point, "speed": 0.05 * (1 + 1j * STEP)}).imag / STEP
    assert fitted(point, slope="speed") == pytest.approx(stepped, rel=1e-10)
