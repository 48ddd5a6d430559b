"""Recorded functions against NumPy: values, derivatives, NaN, branches, and hostile programs."""

from __future__ import annotations

from contextlib import suppress

import numpy as np
import pytest
from hypothesis import given, strategies as st

from actuator_opt.base.numeric import STEP, absolute, positive, real, sqrt, where
from actuator_opt.base.polynomial import moved_root, root_parts, roots
from actuator_opt.base.symbolic import program as programs
from actuator_opt.base.symbolic.arrays import NUMPY_OF, Recorder, SymbolArray, elements
from actuator_opt.base.symbolic.program import Program, program
from actuator_opt.base.symbolic.program_store import MOST_RECORDINGS
from actuator_opt.base.symbolic.recorded import RecordedFunction, same

pytestmark = pytest.mark.skipif(not programs.AVAILABLE, reason="the machine was not built")
VALUES = st.floats(-1e3, 1e3) | st.sampled_from([0.0, -0.0, 1.0, -1.0, np.inf, -np.inf, np.nan])


def recorded(function, point):
    """Recorder and program of a function of (n,) at a point."""
    trace = Recorder()
    symbols = trace.variables([str(k) for k in range(len(point))], point)
    with np.errstate(all="ignore"):
        results = function(symbols[:, 0])
    return trace, program(elements(symbols), elements(results))


def test_the_machine_runs_every_operation_that_is_recorded():
    """An operation added on one side only would keep all designs on NumPy."""
    assert set(NUMPY_OF) - {"real"} == set(programs.OPERATIONS) - {"roots"}


UNARY = (
    np.negative, np.sqrt, np.exp, np.expm1, np.log, np.log1p, np.sin, np.cos, np.tan, np.tanh,
    np.sinh, np.cosh, np.arctan, np.arcsin, np.arccos, np.abs, np.sign, np.floor, np.cbrt,
    np.square, np.reciprocal, np.isnan, np.isfinite, np.isinf,
)  # fmt: skip
BINARY = (
    np.add, np.subtract, np.multiply, np.divide, np.power, np.arctan2, np.hypot, np.copysign,
    np.maximum, np.minimum, np.fmax, np.fmin, np.less, np.less_equal, np.greater,
    np.greater_equal, np.equal, np.not_equal,
)  # fmt: skip


@pytest.mark.parametrize("ufunc", UNARY, ids=lambda u: u.__name__)
@given(value=VALUES)
def test_a_function_of_one_number_is_that_of_numpy(ufunc, value):
    """NaN and infinity included; libraries may round the last digit differently."""
    _, made = recorded(lambda x: ufunc(x), np.array([0.5]))
    with np.errstate(all="ignore"):
        expected = float(ufunc(np.float64(value)))
    got = made.values(np.array([[value]]))[0, 0]
    np.testing.assert_allclose(got, expected, rtol=1e-15, atol=5e-324)


@pytest.mark.parametrize("ufunc", BINARY, ids=lambda u: u.__name__)
@given(first=VALUES, second=VALUES)
def test_a_function_of_two_numbers_is_that_of_numpy(ufunc, first, second):
    """NaN, infinity and the sign of zero included."""
    _, made = recorded(lambda x: ufunc(x[:1], x[1:]), np.array([0.5, 0.7]))
    with np.errstate(all="ignore"):
        expected = float(ufunc(np.float64(first), np.float64(second)))
    got = made.values(np.array([[first, second]]))[0, 0]
    np.testing.assert_allclose(got, expected, rtol=1e-15, atol=5e-324)


SIZED = st.floats(1e-4, 5) | st.floats(-5, -1e-4) | st.just(0.0)
STEPS = st.lists(
    st.tuples(st.integers(0, 11), st.integers(0, 10**6), st.integers(0, 10**6)),
    min_size=1,
    max_size=60,
)


def grown(steps, inputs):
    """Values of a random chain of exactly rounded operations, of numbers or symbols."""
    known = [*inputs, 0 * inputs[0] + 0.3]
    for kind, i, j in steps:
        a, b = known[i % len(known)], known[j % len(known)]
        known.append(
            (
                lambda a, b: a + b,
                lambda a, b: a - b,
                lambda a, b: a * b,
                lambda a, b: a / b,
                lambda a, b: sqrt(a),
                lambda a, b: 1.0 / (1.0 + a * a),
                lambda a, b: absolute(a),
                lambda a, b: where(real(a) < real(b), a, 2.0 * b),
                lambda a, b: positive(a) * b,
                lambda a, b: a * real(b),
                lambda a, b: where(np.isnan(real(a)), 1.0, a),
                lambda a, b: b - 0.0 * a,
            )[kind](a, b)
        )
    return known[len(inputs) :]


@given(steps=STEPS, values=st.lists(SIZED.filter(bool), min_size=3, max_size=3))
def test_random_programs_agree_with_numpy_and_the_complex_step(steps, values):
    """The same bits, NaN in the same places, and slopes as those of the complex step."""
    _, made = recorded(
        lambda x: np.stack(np.broadcast_arrays(*grown(steps, list(x[:, None])))), np.ones(3)
    )
    point = np.array(values)
    with np.errstate(all="ignore"):
        plain = np.array([float(v[0]) for v in grown(steps, [np.array([v]) for v in point])])
        moved = [np.array([v + (1j * STEP if k == d else 0) for d in range(3)])
                 for k, v in enumerate(point)]  # fmt: skip
        stepped = np.array([np.broadcast_to(v, (3,)) for v in grown(steps, moved)]).imag / STEP
    duals = made.duals(programs.NOTHING, point[None], np.eye(3)[None])
    got, slopes = duals[:, :, 0], duals[:, :, 1:]
    np.testing.assert_array_equal(made.values(point[None])[0], plain)
    np.testing.assert_array_equal(got[0], plain)
    # Where a root or a quotient is singular, and at 0, where its square is negative, the complex
    # step has no slope to compare with.
    sound = np.isfinite(plain)[:, None] & np.isfinite(stepped) & (np.abs(stepped) < 1e8)
    sound &= np.isfinite(slopes[0])
    slopes, stepped = slopes[0][sound], stepped[sound]
    assert np.all(np.abs(slopes - stepped) < 1e-6 * np.maximum(np.abs(stepped), 1.0))


def test_many_points_equal_each_point():
    """Points side by side, points one by one, and points with derivatives give the same bits."""
    _, made = recorded(lambda x: np.exp(x) * x[::-1] / (1 + x * x), np.ones(4))
    points = np.random.default_rng(3).normal(size=(101, 4))
    together = made.values(points)
    one_by_one = np.concatenate([made.values(point[None]) for point in points])
    seeds = np.broadcast_to(np.eye(4), (101, 4, 4)).copy()
    assert np.array_equal(together, one_by_one)
    assert np.array_equal(together, made.duals(programs.NOTHING, points, seeds)[:, :, 0])


@pytest.mark.parametrize("groups", [1, 2, 7, 14, 42])
@pytest.mark.parametrize("directions", [0, 1, 7, 11, 15, 20])
def test_shared_inputs_and_sums_equal_each_point(groups, directions):
    """Shared inputs, shared seeds and sums over points, with several points side by side."""
    _, made = recorded(
        lambda x: np.stack([np.sin(x[0]) * x[1], np.where(x[2] > 0, x[3], x[0] / x[2]), -x[0]]),
        np.ones(4),
    )
    rng = np.random.default_rng(groups)
    shared, own = rng.normal(size=(groups, 2)), rng.normal(size=(42, 2))
    seeds = rng.normal(size=(groups, 4, directions))
    each = np.arange(42) * groups // 42
    points = np.concatenate([shared[each], own], axis=1)
    pairs = zip(points, seeds[each], strict=True)
    single = np.concatenate([made.duals(programs.NOTHING, x[None], s[None]) for x, s in pairs])
    assert np.array_equal(made.duals(shared, own, seeds), single)
    summed = made.duals(shared, own, seeds, 6)
    np.testing.assert_allclose(summed, single.reshape(6, 7, 3, -1).sum(axis=1), rtol=1e-12)
    with pytest.raises(ValueError, match="not the points"):
        made.duals(shared, own, seeds, 5)


@pytest.mark.parametrize("count", [2, 9])
@pytest.mark.parametrize("directions", [1, 4, 5, 16, 17, 40])
def test_any_number_of_directions(directions, count):
    """One point at a time, and several side by side; more directions than fit in one run."""
    _, made = recorded(lambda x: x * x, np.ones(3))
    rng = np.random.default_rng(directions)
    seeds, point = rng.normal(size=(count, 3, directions)), rng.normal(size=(count, 3))
    slopes = made.duals(programs.NOTHING, point, seeds)[:, :, 1:]
    assert np.allclose(slopes, 2 * point[:, :, None] * seeds, rtol=1e-15)


@pytest.mark.parametrize("count", [1, 9])
def test_operands_without_slopes(count):
    """The sign of a number, and a condition, give no slope to a constant that they choose."""

    def function(x):
        return np.stack(
            [np.copysign(2.0, x[0]), np.where(x[0], 1.0, 3.0), np.where(x[0], x[1], 3.0)]
        )

    _, made = recorded(function, np.ones(2))
    point, seeds = np.full((count, 2), -3.0), np.tile(np.eye(2), (count, 1, 1))
    duals = made.duals(programs.NOTHING, point, seeds)
    assert duals.tolist() == [[[-2.0, 0.0, 0.0], [1.0, 0.0, 0.0], [-3.0, 0.0, 1.0]]] * count


@given(st.lists(SIZED, min_size=1, max_size=9))
def test_roots_of_polynomials(found):
    """The machine's roots of a polynomial have a residual as small as those of NumPy."""
    coefficients = np.poly(found)[::-1].copy()

    def parts(x):
        return np.stack(root_parts(tuple(x[:, None]))).ravel()

    _, made = recorded(parts, np.arange(1.0, len(coefficients) + 1))
    got = made.values(coefficients[None])[0].reshape(2, -1)
    mine, theirs = got[0] + 1j * got[1], roots(tuple(coefficients))
    powers = np.arange(len(coefficients))

    def residual(z):
        size = np.abs(coefficients) @ np.abs(z) ** powers[:, None] + 1e-300
        return np.max(np.abs(coefficients @ z ** powers[:, None]) / size)

    assert residual(mine) <= max(4 * residual(theirs), 1e-13)


def test_roots_move_with_their_coefficients():
    """A root's slope is -P_k/P' of the coefficient k; roots of degree 2 to 9, some complex."""
    rng = np.random.default_rng(9)
    for degree in range(2, 10):
        coefficients = rng.normal(size=degree + 1)

        def moved(x):
            root = moved_root(tuple(x[:, None]), root_parts(tuple(x[:, None])))
            return np.concatenate([root.real.ravel(), root.imaginary.ravel()])

        _, made = recorded(moved, coefficients)
        duals = made.duals(programs.NOTHING, coefficients[None], np.eye(degree + 1)[None])
        values, slopes = duals[:, :, 0], duals[:, :, 1:]
        at = values[0, :degree] + 1j * values[0, degree:]
        powers = np.arange(degree + 1)
        rise = (powers[1:] * coefficients[1:]) @ at ** powers[:-1, None]
        expected = -(at ** powers[:, None] / rise).T
        got = slopes[0, :degree] + 1j * slopes[0, degree:]
        np.testing.assert_allclose(got, expected, rtol=1e-7, atol=1e-9)


def test_polynomials_without_roots():
    """A zero leading coefficient gives a root at minus infinity; NaN makes all roots NaN."""
    _, made = recorded(lambda x: root_parts(tuple(x[:, None]))[0].ravel(), np.ones(4))
    for coefficients in ([2.0, 1.0, 1.0, 0.0], [1.0, np.nan, 1.0, 1.0], [0.0, 0.0, 0.0, 1.0]):
        mine = np.sort(made.values(np.array([coefficients]))[0])
        with np.errstate(all="ignore"):
            theirs = np.sort(roots(tuple(np.array(coefficients))).real)
        np.testing.assert_allclose(mine, theirs, atol=1e-12)


def stepped(point):
    """Copies of a point (n,) with a complex step in each input."""
    return point[:, None] + 1j * STEP * np.eye(len(point))


def used(function, point):
    """A function that has recorded itself."""
    made = RecordedFunction(function, [str(k) for k in range(len(point))], point)
    made(stepped(point))
    return made


def test_a_function_records_itself():
    """Its recording and its check call the function; after that, the machine runs it."""
    calls = []

    def function(x):
        calls.append(type(x))
        return np.stack([x[0] * x[1], np.exp(x[0])])

    point = np.array([0.3, 2.0])
    made = used(function, point)
    assert calls.count(SymbolArray) == 1
    assert made.reason == ""
    before = len(calls)
    assert np.allclose(made(stepped(point)).imag / STEP, [[2.0, 0.3], [np.exp(0.3), 0.0]])
    assert np.allclose(made(point[:, None]).ravel(), [0.6, np.exp(0.3)])
    assert len(calls) == before


def test_columns_with_equal_points_share_their_values():
    """Columns may repeat a point with other steps, or be other points, in any order."""
    made = used(lambda x: np.stack([x[0] * x[1], x[0] / x[1]]), np.array([0.3, 2.0]))
    rng = np.random.default_rng(1)
    points = rng.normal(size=(2, 3))[:, [0, 0, 1, 2, 2, 2, 0]]
    steps = rng.normal(size=points.shape)
    results = made(points + 1j * STEP * steps)
    expected = np.stack([points[1] * steps[0] + points[0] * steps[1],
                         (steps[0] - points[0] / points[1] * steps[1]) / points[1]])  # fmt: skip
    assert np.allclose(results.imag / STEP, expected, rtol=1e-13)
    assert np.allclose(results.real, [points[0] * points[1], points[0] / points[1]])


def branching(x):
    """A function that asks for the truth of a value."""
    return np.stack([x[0] * 2 if bool(np.any(x[0] > 0)) else x[0] * 3])


def test_a_point_beyond_a_recorded_branch_uses_the_function():
    """The recording holds where the model would take the same branch, and only there."""
    made = used(branching, np.array([1.0]))
    assert np.allclose([made(np.array([[v]]))[0, 0] for v in (2.0, -2.0)], [4.0, -6.0])
    assert made.outside == 1


def test_a_branch_taken_often_is_recorded_anew():
    """After many points beyond the recorded branches, the function is recorded there."""
    made = used(branching, np.array([1.0]))
    for _ in range(60):
        assert made(np.array([[-2.0]]))[0, 0] == -6.0
    assert made.recordings == 2
    for sign in (1, -1) * MOST_RECORDINGS:
        for _ in range(60):
            assert made(np.array([[2.0 * sign]]))[0, 0] == (4.0 if sign > 0 else -6.0)
    assert "branches" in made.reason


@pytest.mark.parametrize(
    ("function", "reason"),
    [
        (lambda x: np.sort(x, axis=0), "sort"),
        (lambda x: np.stack([float(x[0, 0]) * x[1]]), "cannot be recorded"),
        (lambda x: np.linalg.inv(x[:, :1] * np.eye(2))[0], "inv"),
    ],
)
def test_what_cannot_be_recorded_stays_with_numpy(function, reason):
    """The reason is kept; results are those of the function."""
    made = RecordedFunction(function, ["a", "b"], np.ones(2))
    for _ in range(2):
        with suppress(
            TypeError, np.exceptions.ComplexWarning
        ):  # the function itself may refuse complex numbers
            made(stepped(np.array([2.0, 1.0])))
    assert reason in made.reason


def test_a_recording_of_no_points_gives_no_columns():
    """A search whose variables are all fixed has no steps to take."""
    made = used(lambda x: np.stack([x[0] * x[1], x[0] + x[1]]), np.array([2.0, 1.0]))
    assert made.recording is not None
    for dtype in (float, complex):
        assert made(np.empty((2, 0), dtype)).shape == (2, 0)


def test_a_wrong_recording_is_refused():
    """A function that differs for symbols is caught by the check, and not used."""

    def function(x):
        return x * (2.0 if isinstance(x, SymbolArray) else 3.0)

    made = used(function, np.array([1.0]))
    assert made.reason == "the recording differs from the models"
    assert made(np.array([[1.0]]))[0, 0] == 3.0


def test_without_the_machine_the_function_is_used(monkeypatch):
    """An installation without a compiler gives the same numbers."""
    monkeypatch.setattr(programs, "AVAILABLE", False)
    made = used(lambda x: x * x, np.array([3.0]))
    assert "was not built" in made.reason
    assert made(np.array([[3.0]]))[0, 0] == 9.0


def test_results_agree_only_with_equal_nan():
    """A missing NaN, a different infinity or a value beyond rounding is a difference."""
    value = np.array([[1.0, np.nan, np.inf]])
    assert same(value, value + 0.0)
    for k, other in ((0, 1.0 + 1e-8), (1, 1.0), (2, -np.inf), (0, np.nan)):
        changed = value.copy()
        changed[0, k] = other
        assert not same(changed, value)


@given(st.data())
def test_a_damaged_program_is_refused_or_harmless(data):
    """Programs may come from files: no place in memory outside the slots is touched."""
    _, made = recorded(
        lambda x: np.concatenate([root_parts(tuple(x[:, None]))[0].ravel(), x * x]), np.ones(4)
    )
    code, extra, outputs = made.code.copy(), made.extra.copy(), made.outputs.copy()
    for _ in range(data.draw(st.integers(1, 4))):
        array = data.draw(st.sampled_from([code, extra, outputs]))
        place = data.draw(st.integers(0, array.size - 1))
        limits = np.iinfo(array.dtype)
        least, most = int(limits.min), int(limits.max)
        near = st.integers(max(least, -9), 40)
        array.flat[place] = data.draw(st.integers(least, most) | near)
    broken = Program(code, extra, outputs, made.frozen, made.constants, made.slots, made.inputs)
    for attempt in (
        lambda: broken.values(np.ones((40, 4))),
        lambda: broken.duals(programs.NOTHING, np.ones((2, 4)), np.ones((2, 4, 3))),
        lambda: broken.repeated(np.ones(4), 3)(1.0, np.ones(3)),
        lambda: broken.repeated(np.ones(4), 3, [1, 3])(1.0, np.ones(3)),
    ):
        with suppress(ValueError, IndexError, FloatingPointError):  # refused, or no finite value
            attempt()


def shared_program(shared: int):
    """A program of three inputs, the first of which many points share."""
    trace = Recorder()
    x, y, z = trace.variables(["x", "y", "z"], [0.5, 0.7, 1.1])
    results = [np.exp(x) * sqrt(x + 2.0) * y, np.exp(x) + y * z, sqrt(x + 2.0) * 1.5]
    return program(elements(np.stack([x, y, z])), elements(np.stack(results)), shared)


@given(
    sizes=st.lists(st.integers(1, 40), min_size=1, max_size=6),
    shared=st.integers(0, 2),
    directions=st.integers(0, 9),
    summed=st.booleans(),
    apart=st.booleans(),
    seed=st.integers(0, 10**6),
)
def test_groups_of_points_share_inputs_and_slopes(sizes, shared, directions, summed, apart, seed):
    """Results as those of every point alone: some instructions run once for a group."""
    random = np.random.default_rng(seed)
    group = np.repeat(np.arange(len(sizes), dtype=np.int32), sizes)
    common = random.uniform(0.1, 2, (len(sizes), shared))
    own = random.uniform(0.1, 2, (len(group), 3 - shared))
    seeds = random.normal(size=(len(group) if apart else len(sizes), 3, directions))
    made = shared_program(shared)
    assert (made.once > 0) == (shared > 0)
    rows = len(sizes) if summed else None
    found = made.duals(common, own, seeds, rows, group)
    points = np.concatenate([common[group], own], axis=1)
    expected = shared_program(0).duals(np.empty((1, 0)), points, seeds if apart else seeds[group])
    if summed:
        expected = np.add.reduceat(expected, np.searchsorted(group, range(len(sizes))))
    np.testing.assert_allclose(found, expected, rtol=1e-13, atol=1e-13)
    if len(set(sizes)) == 1:
        assert np.array_equal(made.duals(common, own, seeds, rows), found)


@pytest.mark.parametrize("group", [[1, 1], [0, 2], [0, -1], [1, 0], [0], [0, 0, 0]])
def test_groups_out_of_order_are_refused(group):
    """Each group begins at the first point, or after the group before."""
    points = np.ones((2, 1)), np.ones((2, 2)), np.zeros((2, 3, 0))
    with pytest.raises(ValueError, match="not the points"):
        shared_program(1).duals(*points, 2, np.array(group, dtype=np.int32))


def test_fewer_shared_inputs_than_the_program_has_are_correct():
    """Nothing then runs once."""
    own = np.random.default_rng(1).uniform(0.1, 2, (50, 3))
    expected = shared_program(0).values(own)
    assert np.array_equal(shared_program(2).values(own), expected)
    common, rest = np.array([[0.4]]), own[:, 1:]
    whole = np.concatenate([np.full((50, 1), 0.4), rest], axis=1)
    found = shared_program(2).duals(common, rest, np.zeros((1, 3, 0)))[:, :, 0]
    assert np.array_equal(found, shared_program(0).values(whole))
