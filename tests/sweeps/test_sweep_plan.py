"""Points of a sweep: each where its method puts it, from any number on."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from scipy.stats import qmc

from actuator_opt.base.errors import InputError, UsageError
from actuator_opt.design import read_design
from actuator_opt.sweeps import plan, read_axis
from actuator_opt.sweeps.plan import SweepAxis

KNEE = read_design("designs/knee_bonded.yaml").design.model_copy(update={"variables": {}})


def numbers(path, low, high, count=None):
    """A range."""
    return SweepAxis(path, np.array([low, high]), range=True, count=count)


def names(path, size):
    """A list of texts."""
    return SweepAxis(path, None, tuple(f"name{k}" for k in range(size)))


def rows(chosen, first=0, count=None):
    """Every point as a tuple of the combination of texts and the numbers."""
    points = chosen.points(first, chosen.count if count is None else count)
    return list(zip(points.variant.tolist(), *points.numbers.tolist(), strict=True))


@given(st.lists(st.integers(2, 5), min_size=1, max_size=3), st.integers(1, 4), st.integers(1, 40))
def test_a_grid_has_every_combination_once(steps, size, part):
    """A full factorial has each combination once, in chunks as in one piece."""
    axes = [numbers(f"p{k}", 0.0, float(n), n) for k, n in enumerate(steps)] + [names("q", size)]
    chosen = plan(axes, method="grid", count=None)
    every = rows(chosen)
    assert len(every) == len(set(every)) == size * int(np.prod(steps)) == chosen.count
    for k, n in enumerate(steps):
        assert sorted({row[1 + k] for row in every}) == pytest.approx(np.linspace(0, n, n))
    parts = [row for first in range(0, chosen.count, part) for row in rows(chosen, first, part)]
    assert parts == every


@settings(deadline=None)
@given(st.integers(1, 700), st.integers(1, 4), st.integers(0, 9), st.integers(1, 300))
def test_a_latin_hypercube_takes_each_part_of_each_axis_once(count, dimension, seed, part):
    """Of every axis each of n equal parts holds one point, whatever n; chunks are the whole."""
    axes = [numbers(f"p{k}", 0.0, 1.0) for k in range(dimension)]
    chosen = plan(axes, method="lhs", count=count, seed=seed)
    whole = chosen.points(0, count).numbers
    for row in whole:
        assert sorted(np.floor(row * count).astype(int)) == list(range(count))
    parts = [chosen.points(first, part).numbers for first in range(0, count, part)]
    assert np.array_equal(np.concatenate(parts, axis=1), whole)


def test_axes_of_a_latin_hypercube_are_not_alike():
    """Two axes of many points are no more correlated than chance: |r| < 4/sqrt(n)."""
    chosen = plan([numbers(f"p{k}", 0.0, 1.0) for k in range(5)], method="lhs", count=4000)
    table = np.corrcoef(chosen.points(0, 4000).numbers) - np.eye(5)
    assert np.abs(table).max() < 4 / np.sqrt(4000)


def test_sobol_points_are_those_of_scipy_in_any_chunks():
    """The scrambled sequence of the seed, scaled to the ranges; texts are met as often."""
    axes = [numbers("p", 10.0, 20.0), names("q", 4)]
    chosen = plan(axes, method="sobol", count=256, seed=3)
    known = qmc.Sobol(2, scramble=True, rng=np.random.default_rng(3)).random(256).T
    points = chosen.points(0, 256)
    assert points.numbers[0] == pytest.approx(10 + 10 * known[0])
    assert np.bincount(points.variant).tolist() == [64] * 4
    parts = [chosen.points(first, 100).numbers for first in (0, 100, 200)]
    assert np.array_equal(np.concatenate(parts, axis=1), points.numbers)


def test_axes_as_written():
    """Units, a unit given once, bare SI, lists, names; the PATH in its one spelling."""
    one = read_axis("cylinder.bore=18..40 mm:12", KNEE)
    assert one.values == pytest.approx([0.018, 0.04])
    assert (one.count, one.size) == (12, 12)
    assert read_axis("supply.pressure=1e7..2e7", KNEE).values == pytest.approx([1e7, 2e7])
    assert read_axis("load_cases[0].force=3..4 kN:2", KNEE).path == "load_cases[stance].force"
    limits = read_axis("requirements.stiffness_min.min=8,10 kN/mm", KNEE)
    assert limits.numbers() == pytest.approx([8e6, 10e6])
    bare = read_axis("requirements.stiffness_min.min=8e6,1e7", KNEE)
    assert bare.numbers() == pytest.approx([8e6, 10e6])
    named = read_axis("rod.material=steel_42crmo4,ti_6al4v", KNEE)
    assert named.values is None
    assert named.texts == ("steel_42crmo4", "ti_6al4v")


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("cylinder.bore", "no values"),
        ("=1..2", "no values"),
        ("cylinder.bore=", "no values"),
        ("cylinder.bore=18..40 mm:x", "x steps"),
        ("cylinder.bore=18..40 mm:1", "1 steps"),
        ("cylinder.bore=18..40 mm:", "no number of steps"),
        ("cylinder.bore=20 mm..20 mm:3", "both ends of the range are equal"),
        ("cylinder.bore=20 mm,,30 mm", "one of the values is empty"),
        ("cylinder.bore=20 mm,20 mm", "a value is given twice"),
        ("cylinder.bore=20 mm,2 cm", "a value is given twice"),
        (
            "load_cases[stance].position=10 %..90 %:3",
            "has another unit or type than the value",
        ),
        ("name=one,two", "that no model uses"),
        ("objective.minimise=mass,seal_gap", "that no model uses"),
        ("cylinder.bohr=1..2:3", "unknown PATH"),
        ("cylinder.bore=1 bar..2 bar:3", "bar is a pressure"),
        ("cylinder.bore=20..9000 mm:3", "9000 mm"),
        ("rod.material=steel..gold:3", "unknown material"),
        ("rod.material=steel_42crmo4,gold", "unknown material"),
        ("barrel=1..2:3", "names a block"),
    ],
)
def test_what_is_no_axis_is_said_in_one_line(text, words):
    """A fault names what is wrong and what to write."""
    with pytest.raises((UsageError, InputError)) as caught:
        read_axis(text, KNEE)
    (fault,) = caught.value.diagnostics
    assert words in str(fault)


@pytest.mark.parametrize(
    ("axes", "method", "count", "words"),
    [
        ([], "grid", None, "nothing to vary"),
        ([numbers("p", 0, 1)], "grid", None, "has no steps"),
        (
            [numbers("p", 0, 1, 3)],
            "grid",
            5,
            "the steps of a grid already determine its number of points",
        ),
        ([numbers("p", 0, 1)], "lhs", None, "number of points missing"),
        ([numbers("p", 0, 1)], "sobol", 0, "-n 0"),
        ([numbers("p", 0, 1)], "sobol", 2**31, "1 to 1073741824"),
        ([numbers("p", 0, 1, 3), numbers("p", 0, 1, 3)], "grid", None, "given twice"),
        ([numbers("p", 0, 1, 10**12 + 1)], "grid", None, "1 000 000 000 001 points"),
    ],
)
def test_what_is_no_sweep_is_said_in_one_line(axes, method, count, words):
    """An empty sweep, missing steps or points, a PATH twice."""
    with pytest.raises(UsageError, match=words):
        plan(axes, method=method, count=count)


@pytest.mark.parametrize(("dimension", "first"), [(1, 1), (3, 4090), (6, 70_001)])
def test_sobol_points_are_those_of_the_library_in_its_order(dimension, first):
    """Points from any number on are, to the bit, those that the library comes to one by one."""
    engine = qmc.Sobol(dimension, scramble=True, rng=np.random.default_rng(5))
    engine.fast_forward(first)
    expected = engine.random(128).T
    axes = [numbers(f"p{k}", 0.0, 1.0) for k in range(dimension)]
    points = plan(axes, method="sobol", count=100_000, seed=5).points(first, 128)
    assert (points.numbers == expected).all()
