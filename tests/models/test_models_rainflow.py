"""Claims about counted cycles: published counts, the four-point rule, any beginning."""

from __future__ import annotations

from collections import Counter

import numpy as np
import pytest
from counted_cycles import cycle_stress
from hypothesis import given, strategies as st

from actuator_opt.base.symbolic import program as programs
from actuator_opt.models import rainflow

EXAMPLE = [0.0, 210.0, 80.0, 150.0, 20.0, 120.0, 0.0]
ASTM = [-2.0, 1.0, -3.0, 5.0, -1.0, 3.0, -4.0, 4.0, -2.0]
"""History of the example of ASTM E1049-85, section 5.4."""

whole = st.integers(-5, 5)
"""Few values, so that many are equal."""
histories = st.one_of(
    st.lists(whole.map(float), min_size=1, max_size=40),
    st.lists(st.floats(-1e9, 1e9), min_size=1, max_size=40),
)


@pytest.fixture(params=[True, False], ids=["compiled", "numpy"], autouse=True, scope="module")
def counted_by(request):
    """Every claim holds with the compiled machine and without it."""
    if request.param and not programs.AVAILABLE:
        pytest.skip("the machine was not built")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(programs, "AVAILABLE", request.param)
        yield


def values_of(history):
    """Largest and smallest value of every cycle, with its number."""
    cycles = rainflow.repeating_cycles(history=history)
    assert set(cycles.count.tolist()) <= {1.0}
    return Counter((history[i], history[k]) for i, k in zip(*cycles[:2], strict=True))


def four_point(history):
    """Cycles by the four-point rule: a range inside both its neighbours is a cycle and is removed.

    What remains of a history from its largest value round to it is one last cycle.
    """
    start = history.index(max(history))
    found, stack = Counter(), []
    for value in [*history[start:], *history[: start + 1]]:
        if stack and value == stack[-1]:
            continue
        if len(stack) > 1 and (stack[-1] > stack[-2]) == (value > stack[-1]):
            stack.pop()  # no reversal
        stack.append(value)
        while len(stack) > 3:
            a, b, c, d = stack[-4:]
            if min(b, c) < min(a, d) or max(b, c) > max(a, d):
                break
            found[max(b, c), min(b, c)] += 1
            del stack[-3:-1]
    assert len(stack) in (1, 3)
    if len(stack) == 3:
        found[stack[0], stack[1]] += 1
    return found


def test_worked_example():
    """Three cycles, and no half cycle."""
    assert values_of(EXAMPLE) == Counter({(150.0, 80.0): 1, (120.0, 20.0): 1, (210.0, 0.0): 1})


def test_example_of_the_standard():
    """Ranges 9, 7, 4 and 3, each once: E1049-85 section 5.4.5."""
    found = values_of(ASTM)
    assert Counter(high - low for high, low in found) == Counter([9.0, 7.0, 4.0, 3.0])
    assert found == four_point(ASTM)


@given(histories)
def test_equals_the_four_point_rule(history):
    """Cycles of the three-point rule on the rotated history are those of the four-point rule."""
    assert values_of(history) == four_point(history)


@given(histories, st.integers(0, 39))
def test_beginning_of_the_file_does_not_matter(history, shift):
    """A rotated history, or one closed by its first sample, has the same cycles."""
    shift %= len(history)
    found = values_of(history)
    assert values_of([*history[shift:], *history[:shift]]) == found
    assert values_of([*history, history[0]]) == found


@given(histories)
def test_cycles_cover_the_path(history):
    """The ranges of the cycles, up and down, add up to the path of the closed history."""
    path = sum(abs(b - a) for a, b in zip(history, [*history[1:], history[0]], strict=True))
    ranges = sum(2 * number * (high - low) for (high, low), number in values_of(history).items())
    assert ranges == pytest.approx(path, rel=1e-12, abs=1e-6)


@given(histories)
def test_two_repeats_have_every_cycle_twice(history):
    """A history that is read twice counts each of its cycles twice."""
    once = values_of(history)
    assert values_of([*history, *history]) == Counter({pair: 2 * n for pair, n in once.items()})


def test_size_of_the_values_does_not_matter():
    """Only their order does: products of such small differences would underflow to zero."""
    tiny = [3e-200, 1e-200, 2e-200, 0.0]
    assert values_of(tiny) == Counter({(2e-200, 1e-200): 1, (3e-200, 0.0): 1})


@pytest.mark.parametrize("history", [[7.0], [7.0, 7.0, 7.0]])
def test_constant_history_has_no_cycle(history):
    """Neither one sample nor several equal ones are a cycle."""
    cycles = rainflow.repeating_cycles(history=history)
    assert cycles.largest.shape == cycles.count.shape == (0,)


def test_nan_gives_nan():
    """Stress of an impossible design is not counted as harmless."""
    history = [0.0, 5.0, np.nan, 5.0]
    stress = cycle_stress(history, rainflow.repeating_cycles(history=history))
    assert np.isnan(stress.amplitude).all()


def test_columns_are_histories_of_their_own():
    """Shorter columns are filled up with cycles that count zero and have no amplitude."""
    columns = np.array([ASTM[:-1], [7.0] * 8, [0.0, 9.0, 0.0, 1.0, 0.0, 1.0, 0.5, 0.0]]).T
    cycles = rainflow.repeating_cycles(history=columns)
    stress = cycle_stress(columns, cycles)
    assert cycles.count.sum(axis=0).tolist() == [4.0, 0.0, 3.0]
    for k, column in enumerate(columns.T):
        used = cycles.count[:, k] > 0
        pairs = zip(
            (stress.mean + stress.amplitude)[used, k],
            (stress.mean - stress.amplitude)[used, k],
            strict=True,
        )
        assert Counter(pairs) == values_of(column.tolist())
        assert not stress.amplitude[~used, k].any()


def test_slopes_are_those_of_the_paired_samples():
    """Each value moves half of amplitude and mean of its cycle, by a complex step."""
    history = np.array(EXAMPLE, dtype=complex)
    history[2] += 1e-30j  # the smallest of the cycle (150, 80)
    cycles = rainflow.repeating_cycles(history=history)
    stress = cycle_stress(history, cycles)
    at = cycles.smallest.tolist().index(2)
    slopes = np.imag(stress.amplitude) / 1e-30, np.imag(stress.mean) / 1e-30
    assert np.flatnonzero(slopes[0]).tolist() == np.flatnonzero(slopes[1]).tolist() == [at]
    assert (slopes[0][at], slopes[1][at]) == pytest.approx((-0.5, 0.5))


@pytest.mark.skipif(not programs.AVAILABLE, reason="the machine was not built")
def test_wrong_memory_is_refused():
    """The compiled machine writes only to arrays of the right size."""
    values, pairs, counts = (
        np.zeros((2, 5)),
        np.zeros((2, 5, 2), np.int32),
        np.full(2, -1, np.int32),
    )
    for bad in (
        (values[:, :4].copy(), pairs, counts),
        (values, pairs, np.zeros(3, np.int32)),
        (values, pairs[:1], counts),
    ):
        with pytest.raises(ValueError, match="histories"):
            programs.COMPILED.cycles(*bad)
    programs.COMPILED.cycles(np.zeros((2, 0)), pairs[:, :0].copy(), counts)
    assert counts.tolist() == [0, 0]


def test_infinite_values_are_counted():
    """Only an unknown value makes the cycles unknown."""
    assert values_of([1.0, np.inf, 2.0, -np.inf, 3.0]) == Counter(
        {(np.inf, -np.inf): 1, (3.0, 1.0): 1}
    )
