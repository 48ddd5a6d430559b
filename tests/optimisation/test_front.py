"""Fronts of several objectives against closed forms: on the front, all of it, evenly."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from actuator_opt.optimisation.front import tracer
from actuator_opt.optimisation.front.front import Front, FrontSettings, front
from actuator_opt.optimisation.front.objectives import Objectives
from actuator_opt.optimisation.problem import BoxProblem, PointValues


def objectives(lower, upper, evaluate, names=("f1", "f2"), constraints=(), **more):
    """A box with objectives."""
    n = len(lower)
    problem = BoxProblem(
        tuple(f"x{i}" for i in range(n)),
        np.array(lower, dtype=float),
        np.array(upper, dtype=float),
        evaluate, constraints, **more,
    )  # fmt: skip
    return Objectives(names, problem, evaluate)


def found(problem, count, **more) -> Front:
    """Its front, which holds what every front must."""
    result = front(problem, FrontSettings(count, samples=256, **more))
    assert isinstance(result, Front)
    assert result.residuals.max() <= 1e-6
    assert tracer.nondominated(result.values).all()
    return result


def ratio(result):
    """Largest gap over the median."""
    return result.gaps.max() / np.median(result.gaps)


def two_targets(a, b, **more):
    """Nearest to two points at once: sqrt(f1) + sqrt(f2) = |a - b|, on the line between them."""
    a, b = np.array(a, dtype=float)[:, None], np.array(b, dtype=float)[:, None]

    def evaluate(x):
        return PointValues([((x - a) ** 2).sum(axis=0), ((x - b) ** 2).sum(axis=0)])

    return objectives([-3.0] * len(a), [3.0] * len(a), evaluate, **more)


def test_nearest_to_two_points():
    """Optima without a constraint in force: gradients vanish at the anchors."""
    result = found(two_targets([0, 0, 0], [1, 1, 1]), 30)
    roots = np.sqrt(np.maximum(result.values, 0))
    np.testing.assert_allclose(roots.sum(axis=0), np.sqrt(3), rtol=1e-6)
    np.testing.assert_allclose(result.values[:, 0], [0, 3], atol=1e-6)
    np.testing.assert_allclose(result.values[:, -1], [3, 0], atol=1e-6)
    assert result.values.shape == (2, 30)
    assert ratio(result) <= 1.5
    knee, depth = result.knee
    # f1 = f2 = 3/4 at the middle, 1/4 of the range: (1 - 1/2)/sqrt(2) below the line of the anchors
    assert abs(knee - 14.5) <= 1
    assert depth == pytest.approx(0.5 / np.sqrt(2), rel=0.01)


@settings(max_examples=8, deadline=None)
@given(
    st.lists(st.floats(-1, 1), min_size=2, max_size=4),
    st.integers(0, 5),
    st.integers(3, 12),
)
def test_any_two_points(a, shift, count):
    """The law holds for any two points; nothing returned dominates anything else."""
    b = [x + 0.5 + 0.25 * ((i + shift) % 4) for i, x in enumerate(a)]
    result = found(two_targets(a, b), count, checks=0)
    distance = np.linalg.norm(np.subtract(a, b))
    np.testing.assert_allclose(
        np.sqrt(np.maximum(result.values, 0)).sum(axis=0), distance, rtol=1e-5
    )
    assert result.values.shape[1] == count


def test_without_complex_numbers():
    """A model that takes no complex numbers is searched point by point, to the same front."""
    result = found(two_targets([0, 0], [1, 0.5], **{}), 5, checks=0)
    problem = two_targets([0, 0], [1, 0.5])
    slow = replace(problem, problem=replace(problem.problem, has_complex_step=False))
    other = front(slow, FrontSettings(5, samples=64, checks=0))
    assert other.warnings
    np.testing.assert_allclose(other.values, result.values, atol=1e-4)


def circle(**more):
    """Values x outside the unit circle: a front that bends away from the ideal."""

    def evaluate(x):
        return PointValues([x[0], x[1]], ((x**2).sum(axis=0) - 1)[None])

    return objectives([0, 0], [2, 2], evaluate, constraints=("outside",), **more)


def test_hollow_front():
    """No weighted sum finds more than the ends of this one; it has no knee."""
    result = found(circle(), 41)
    np.testing.assert_allclose(np.hypot(*result.values), 1, rtol=1e-9)
    np.testing.assert_allclose(result.values[:, [0, -1]], [[0, 1], [1, 0]], atol=1e-9)
    assert result.knee is None
    assert ratio(result) <= 2


def test_same_seed_same_front():
    """Bytes repeat."""
    first, second = (found(circle(), 12, seed=3) for _ in range(2))
    assert first.x.tobytes() == second.x.tobytes()
    assert first.values.tobytes() == second.values.tobytes()


def waves(x):
    """Falls, rises and falls again, twice."""
    return 1 - x - 0.25 * np.sin(4 * np.pi * x)


def test_front_in_pieces():
    """f2 rises again on the way: the front jumps, and every piece of it is covered."""

    def evaluate(x):
        return PointValues([x[0], waves(x[0]) + x[1] ** 2])

    result = found(objectives([0, -1], [1, 1], evaluate), 40)
    dense = np.linspace(0, 1, 200_001)
    best = np.minimum.accumulate(waves(dense))
    on_front = np.isclose(waves(dense), best, atol=1e-12) & (np.r_[np.inf, best[:-1]] > best)
    np.testing.assert_allclose(result.values[1], waves(result.values[0]), atol=1e-8)
    at = np.interp(result.values[0], dense, best)
    np.testing.assert_allclose(result.values[1], at, atol=1e-4)  # none behind a better one
    inside = dense[on_front]
    jumps = np.flatnonzero(np.diff(inside) > 1e-4)
    assert len(jumps) == 2  # by the closed form
    for last, first in zip(inside[jumps], inside[jumps + 1], strict=True):
        before = result.values[0][result.values[0] <= last + 1e-6].max()
        assert before == pytest.approx(last, abs=1e-4)
        assert not ((result.values[0] > last + 1e-4) & (result.values[0] < first - 1e-4)).any()
    rest = np.sort(result.gaps)[:-2]
    assert rest.max() <= 3 * np.median(rest)
    assert result.values.shape[1] == 40


def pieces_of(curve, result):
    """Ends of the jumps of a dense front f2 = curve(f1), and a lookup of the best f2 so far."""
    dense = np.linspace(0, 1, 200_001)
    best = np.minimum.accumulate(curve(dense))
    inside = dense[np.isclose(curve(dense), best, atol=1e-12) & (np.r_[np.inf, best[:-1]] > best)]
    wide = np.ptp(result.values, axis=1)
    across = np.hypot(np.diff(inside) / wide[0], np.diff(curve(inside)) / wide[1])
    jumps = np.flatnonzero(across > 1e-3)
    return [(inside[k], inside[k + 1], across[k]) for k in jumps]


@pytest.mark.long
@settings(max_examples=10, deadline=None)
@given(st.floats(0.05, 0.4), st.floats(1, 3), st.floats(0, 6), st.integers(20, 60))
def test_gaps_are_even_or_jumps(height, waves_, shift, count):
    """Whatever the pieces: gaps are within three times the median but at jumps, told as such."""

    def curve(x):
        return 1 - x - height * np.sin(2 * np.pi * waves_ * x + shift)

    def evaluate(x):
        return PointValues([x[0], curve(x[0]) + x[1] ** 2])

    result = found(objectives([0, -1], [1, 1], evaluate), count)
    assert all(gap.jump for gap in result.wide)
    jumps = [gap.after for gap in result.wide]
    steps = np.delete(result.gaps, jumps)
    assert steps.max() <= 3 * np.median(result.gaps) * (1 + 1e-9)
    known = pieces_of(curve, result)
    for gap in result.wide:  # the closed form jumps there too, but for what may be hidden
        left, right = result.values[0, gap.after : gap.after + 2]
        held = sum(wide for low, high, wide in known if left - 1e-4 <= low and high <= right + 1e-4)
        assert held >= gap.size - 2 * gap.reach - 1e-3


@pytest.mark.long
@settings(max_examples=8, deadline=None)
@given(st.floats(0.003, 1), st.floats(1, 8), st.integers(12, 40))
def test_bent_fronts_are_even(sharp, power, count):
    """A hyperbola of slopes up to 1e5, then a hollow power law: in one piece, with no wide gap."""

    def full(x):
        return PointValues([x[0], 1 / (x[0] + sharp) + x[1] ** 2])

    def hollow(x):
        return PointValues([x[0], 1 - x[0] ** power + x[1] ** 2])

    for evaluate in (full, hollow):
        result = found(objectives([0, -1], [1, 1], evaluate), count)
        np.testing.assert_allclose(result.x[1], 0, atol=1e-3)
        assert result.wide == ()
        assert ratio(result) <= 3
        assert result.values.shape[1] == count


@pytest.mark.long
def test_where_steps_stick():
    """In logarithms the ends of the hollow circle hold steps back; wide gaps are searched anew."""

    def evaluate(x):
        return PointValues([x[0], x[1]], ((x**2).sum(axis=0) - 1)[None])

    result = found(objectives([1e-4, 1e-4], [1, 1], evaluate, constraints=("outside",)), 12)
    np.testing.assert_allclose(np.hypot(*result.values), 1, rtol=1e-7)
    assert result.wide == ()
    assert ratio(result) <= 3


def test_valley_changes_along_the_front():
    """The better of two valleys changes at half way; what is merely local is left out."""

    def evaluate(x):
        f1, valley = x
        return PointValues([f1, 1 - f1 + (valley**2 - 1) ** 2 + 0.3 * valley * (f1 - 0.5)])

    start = np.array([0.5, 1.0])
    result = found(objectives([0, -2], [1, 2], evaluate, start=start), 25)
    valley = np.linspace(-2, 2, 40_001)[:, None]
    for f1, f2 in result.values.T:
        best = (1 - f1 + (valley**2 - 1) ** 2 + 0.3 * valley * (f1 - 0.5)).min()
        assert f2 == pytest.approx(best, abs=1e-6)
    sides = np.sign(result.x[1])
    assert (sides[result.values[0] < 0.49] > 0).all()
    assert (sides[result.values[0] > 0.51] < 0).all()


def test_an_end_that_its_objective_does_not_settle():
    """f1 says nothing of x1: the end is the best of the others there, not any one."""

    def evaluate(x):
        return PointValues([x[0], 1 / x[0] + (x[1] - 0.3) ** 2])

    result = found(objectives([1, -1], [4, 1], evaluate, start=np.array([2, -1.0])), 15)
    np.testing.assert_allclose(result.values[1], 1 / result.values[0], rtol=1e-6)
    np.testing.assert_allclose(result.values[0, [0, -1]], [1, 4], rtol=1e-6)


def test_sphere_octant():
    """Three objectives within the ball about (1, 1, 1); all of the octant is covered."""

    def evaluate(x):
        return PointValues(list(x), (1 - ((x - 1) ** 2).sum(axis=0))[None])

    problem = objectives([0] * 3, [2] * 3, evaluate, ("f1", "f2", "f3"), ("sphere",))
    result = found(problem, 60, checks=1)
    assert result.values.shape == (3, 60)
    np.testing.assert_allclose(((result.values - 1) ** 2).sum(axis=0), 1, rtol=1e-6)
    assert result.values.max() <= 1 + 1e-4
    assert result.values.min() >= -1e-8
    # every place of the octant has a design near it
    axis = np.linspace(0, np.pi / 2, 9)
    polar, around = (a.ravel() for a in np.meshgrid(axis, axis))
    there = np.stack(
        [np.sin(polar) * np.cos(around), np.sin(polar) * np.sin(around), np.cos(polar)]
    )
    there = 1 - there
    away = np.sqrt(((result.values[:, None, :] - there[:, :, None]) ** 2).sum(axis=0)).min(axis=1)
    assert away.max() <= 0.3
    assert result.gaps.max() <= 3 * np.median(result.gaps)
    spot = result.values[:, result.knee[0]]
    np.testing.assert_allclose(spot, 1 - 1 / np.sqrt(3), atol=0.1)


def test_four_objectives():
    """The ball again, in four dimensions."""

    def evaluate(x):
        return PointValues(list(x), (1 - ((x - 1) ** 2).sum(axis=0))[None])

    names = ("f1", "f2", "f3", "f4")
    result = found(objectives([0] * 4, [2] * 4, evaluate, names, ("ball",)), 40, checks=0)
    np.testing.assert_allclose(((result.values - 1) ** 2).sum(axis=0), 1, rtol=1e-8)
    assert result.values.shape == (4, 40)


def test_no_conflict_is_one_point():
    """Both objectives are best at one design."""

    def evaluate(x):
        return PointValues([(x[0] - 0.2) ** 2 + 1, 2 * (x[0] - 0.2) ** 2 + 3])

    result = found(objectives([-1], [1], evaluate), 10)
    np.testing.assert_allclose(result.values, [[1], [3]])
    assert result.knee is None
    assert len(result.gaps) == 0


def test_infeasible_is_told():
    """Where nothing is feasible the search that shows it is handed back."""

    def evaluate(x):
        return PointValues([x[0], -x[0]], (x[0] - 2)[None])

    result = front(objectives([0], [1], evaluate, constraints=("g",)), FrontSettings(5))
    assert not isinstance(result, Front)
    assert result.solution.violation == pytest.approx(1)


def test_nondominated_against_the_definition():
    """Every pair compared."""
    values = np.random.default_rng(0).integers(0, 6, (3, 80)).astype(float)
    kept = tracer.nondominated(values)
    for k in range(80):
        beaten = any(
            (values[:, j] <= values[:, k]).all() and (values[:, j] < values[:, k]).any()
            for j in range(80)
        )
        assert kept[k] == (not beaten)
