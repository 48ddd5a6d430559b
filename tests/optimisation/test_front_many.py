"""Fronts of three and four objectives against closed forms: all of them, evenly, and nothing else.

How even a choice of designs can be is told by the greedy one from a dense sample of the closed form
[Gonzalez1985]: what is found from nothing must come near it.
"""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest
from test_front import objectives

from actuator_opt.optimisation.front import plane as cells, tracer
from actuator_opt.optimisation.front.front import Front, FrontSettings, front
from actuator_opt.optimisation.problem import PointValues

NAMES = ("f1", "f2", "f3", "f4")


def weights(count, steps):
    """A dense lattice of the unit simplex (count, k)."""
    return (
        np.array([w for w in product(range(steps + 1), repeat=count) if sum(w) == steps]).T / steps
    )


def full_ball(count, dense):
    """Within the ball about (1, 1, ...): the part of it that faces the ideal."""

    def evaluate(x):
        return PointValues(list(x), (1 - ((x - 1) ** 2).sum(axis=0))[None])

    return evaluate, ([0] * count, [2] * count), 1 - dense / np.linalg.norm(dense, axis=0)


def hollow_ball(count, dense):
    """Outside the ball about 0: anchors whose objective leaves the others open."""

    def evaluate(x):
        return PointValues(list(x), ((x**2).sum(axis=0) - 1)[None])

    return evaluate, ([0] * count, [2] * count), dense / np.linalg.norm(dense, axis=0)


def plane(count, dense):
    """x1 + x2 + ... >= 1: every design is best for equal weights, the anchors are any of a face."""

    def evaluate(x):
        return PointValues(list(x), (x.sum(axis=0) - 1)[None])

    return evaluate, ([0] * count, [2] * count), dense


def skew_ball(count, dense):
    """A ball seen at a slant, -M w / sqrt(w M w): an objective is worst between two anchors."""
    m = np.full((count, count), -0.4) + 1.4 * np.eye(count)
    factor = np.linalg.cholesky(m)

    def evaluate(x):
        return PointValues(list(np.tensordot(factor, x, axes=1)), (1 - (x**2).sum(axis=0))[None])

    there = -(m @ dense) / np.sqrt((dense * (m @ dense)).sum(axis=0))
    return evaluate, ([-1.5] * count, [1.5] * count), there


def angles(count, dense):
    """The hollow ball by its angles and two variables that only make it worse [Deb2005]."""

    def evaluate(x):
        size = 1 + ((x[count - 1 :] - 0.5) ** 2).sum(axis=0)
        turned = x[: count - 1] * np.pi / 2
        values = []
        for i in range(count):
            value = size * np.prod(np.cos(turned[: count - 1 - i]), axis=0)
            values.append(value * np.sin(turned[count - 1 - i]) if i else value)
        return PointValues(values)

    bounds = ([0] * (count + 1), [1] * (count + 1))
    return evaluate, bounds, dense / np.linalg.norm(dense, axis=0)


def greedy_radius(dense, count):
    """Covering radius of the greedy choice of so many."""
    first = np.array([int(np.argmin(dense[0]))])
    kept = tracer.thinned(dense, first, count)
    return away(dense, dense[:, kept]).max()


def away(dense, chosen):
    """Distance of each of the dense (m, k) to the nearest of those chosen."""
    return np.sqrt(((dense[:, :, None] - chosen[:, None, :]) ** 2).sum(axis=0)).min(axis=1)


def searched(evaluate, bounds, names, count, **more) -> Front:
    """Its front, which holds what every front must."""
    constraints = () if evaluate(np.zeros((len(bounds[0]), 1))).constraints is None else ("in",)
    problem = objectives(*bounds, evaluate, names, constraints)
    result = front(problem, FrontSettings(count, samples=256, **more))
    assert isinstance(result, Front)
    assert result.residuals.max() <= 1e-6
    assert tracer.nondominated(result.values).all()
    assert result.values.shape == (len(names), count)
    return result


@pytest.mark.long
@pytest.mark.parametrize(
    ("shape", "objective_count", "count", "most", "short"),
    [
        (full_ball, 3, 60, 1.35, 0.03),
        (hollow_ball, 3, 60, 1.35, 0.03),
        pytest.param(skew_ball, 3, 60, 1.35, 0.03, marks=pytest.mark.long),
        (angles, 3, 40, 1.45, 0.03),
        (plane, 3, 60, 1.6, 0.05),
        (hollow_ball, 4, 60, 1.35, 0.03),
    ],
)
def test_covers_all_of_it(shape, objective_count, count, most, short):
    """The largest hole is near that of the best of the dense sample; every design is on it.

    No anchor marks the corners of the plane: they are reached within half the spacing of 60 even
    designs, of 10 or 11 along an edge, 1/9.5/2 of the range.
    """
    dense = weights(objective_count, 60 if objective_count == 3 else 16)
    evaluate, bounds, there = shape(objective_count, dense)
    result = searched(evaluate, bounds, NAMES[:objective_count], count, checks=1)
    low, wide = there.min(axis=1)[:, None], np.ptp(there, axis=1)[:, None]
    unit, own = (there - low) / wide, (result.values - low) / wide
    assert away(unit, own).max() <= most * greedy_radius(unit, count)
    assert away(own, unit).max() <= 2.5 * np.median(tracer.nearest(unit))
    assert result.gaps.max() <= 3 * np.median(result.gaps)
    np.testing.assert_allclose(own.min(axis=1), 0, atol=0.03)
    np.testing.assert_allclose(own.max(axis=1), 1, atol=short)


@pytest.mark.long
def test_front_in_four_pieces():
    """f3 falls, rises and falls along f1 and along f2: two pieces of each, four of the front."""

    def waves(x):
        return x / 2 * (1 + np.sin(3 * np.pi * x))

    def evaluate(x):
        return PointValues([x[0], x[1], 3 - waves(x[0]) - waves(x[1]) + x[2] ** 2])

    result = searched(evaluate, ([0, 0, -1], [1, 1, 1]), NAMES[:3], 60, checks=1)
    dense = np.linspace(0, 1, 100_001)
    best = np.minimum.accumulate(-waves(dense))
    on_front = np.isclose(-waves(dense), best, atol=1e-12)
    on_front &= np.r_[np.inf, best[:-1]] > best
    jump = dense[on_front][:-1][np.diff(dense[on_front]) > 0.01]
    assert len(jump) == 1
    sides = result.values[:2] > jump[0] + 1e-3
    for f in result.values[:2]:
        assert np.interp(f, dense, -waves(dense) - best).max() <= 1e-4
    pieces = [
        ((sides[0] == a) & (sides[1] == b)).sum() for a, b in product((False, True), repeat=2)
    ]
    assert min(pieces) >= 8


def test_places_of_a_lattice():
    """Levels of places add up to one; those next to one are all equally far from it."""
    for count, steps in ((3, 4), (4, 2)):
        places = cells.places(count, steps)
        levels = np.stack([cells.level(place, steps) for place in places], axis=1)
        np.testing.assert_allclose(levels.sum(axis=0), 1)
        assert (np.ptp(levels, axis=0) <= 1 + 1e-12).all()
        assert len(set(places)) == len(places)
        near = cells.around((0,) * count)
        assert len(set(near)) == count * (count - 1)
        apart = [np.linalg.norm(cells.level(p, steps) - 1 / count) for p in near]
        np.testing.assert_allclose(apart, np.sqrt(2) / steps)
