"""Equations in time: machine and generated Python give the formulas, or say that none holds."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from actuator_opt.base.symbolic import Equations, Graph, Namespace, jacobian, program as programs
from actuator_opt.base.symbolic.program import program

MACHINE = pytest.param(
    True, marks=pytest.mark.skipif(not programs.AVAILABLE, reason="the machine was not built")
)
both = pytest.mark.parametrize("by_machine", [MACHINE, False])
reals = st.floats(-3.0, 3.0)


def law(xp, t, x, y, flag):
    """Every operation that a model may use."""
    return [
        x + y, x - t, 3.0 * x * y, x / (2.0 + y * y), -x, xp.exp(x), xp.expm1(x), xp.tanh(x * y),
        xp.sin(x * t), xp.cos(y), xp.log(1.0 + x * x), xp.log1p(y * y), xp.atan2(x, y + 4.0),
        xp.sqrt(x * x + y * y + 0.01), (1.0 + x * x) ** 0.3, (2.0 + y * y) ** -1.7,
        xp.where(x < y, x * x, xp.exp(y)), xp.where((x <= y) & ~(y < 0.0), x, y),
        xp.where(flag, x * y, t), xp.where((x < 0.0) | flag, -x, y * y), 7.0, t,
    ]  # fmt: skip


def made(outputs, *, by_machine, monkeypatch, graph, names=("x", "y"), flags=("m",)):
    """Equations of outputs in the states of these names."""
    monkeypatch.setattr(programs, "AVAILABLE", by_machine)
    states = [graph.variable(name) for name in names]
    found = Equations(
        graph.variable("t"), states, [graph.flag(name) for name in flags],
        outputs(graph.variable("t"), *states, *(graph.flag(name) for name in flags)),
    )  # fmt: skip
    assert (found._program is not None) == by_machine
    return found


@both
@given(t=reals, x=reals, y=reals, m=st.booleans())
@settings(max_examples=40, deadline=None)
def test_every_operation_has_its_value_and_slope(by_machine, t, x, y, m):
    """The values are NumPy's; the slopes are differences of values, where these are smooth."""
    with pytest.MonkeyPatch.context() as patch:
        own = made(
            lambda *symbols: law(Namespace, *symbols),
            by_machine=by_machine, monkeypatch=patch, graph=Graph(),
        )  # fmt: skip
    at, state = own.at_point((m,)), np.array([x, y])
    expected = [float(v) for v in law(np, t, *state, np.bool_(m))]
    assert list(at.values(t, state)) == pytest.approx(expected, rel=1e-13, abs=1e-13)
    assert at.latest().tolist() == [t, x, y]
    many = own.at_samples(np.full(3, t), np.tile(state[:, None], 3), [np.full(3, m)])
    assert many == pytest.approx(np.tile(np.array(expected)[:, None], 3), rel=1e-13, abs=1e-13)
    if min(abs(x - y), abs(x), abs(y)) < 1e-3:
        return  # a choice changes nearby
    step = 1e-5
    slopes = at.slopes(t, state).copy()
    for k in range(2):
        change = step * np.eye(2)[k]
        rise = np.array(at.values(t, state + change)) - np.array(list(at.values(t, state - change)))
        assert slopes[:, k] == pytest.approx(rise / (2 * step), rel=1e-6, abs=1e-5)


@both
def test_slopes_along_more_states_than_the_machine_takes_at_once(by_machine, monkeypatch):
    """A rate of 40 states: the derivative of sum k x_k^2 is 2 k x_k; unused states have none."""
    own = made(
        lambda t, *x: [sum(k * v * v for k, v in enumerate(x) if k % 3), x[1], 2.0],
        by_machine=by_machine, monkeypatch=monkeypatch, graph=Graph(),
        names=[f"x{k}" for k in range(40)], flags=(),
    )  # fmt: skip
    x = np.linspace(-1.0, 2.0, 40)
    found = own.at_point(()).slopes(0.0, x)
    number = np.arange(40)
    expected = np.zeros((3, 40))
    expected[0] = np.where(number % 3 > 0, 2 * number * x, 0.0)
    expected[1, 1] = 1.0
    assert found == pytest.approx(expected, rel=1e-14)


@both
def test_tables_are_looked_up_at_the_time(by_machine, monkeypatch):
    """A record stands in values, samples and time derivatives, also at one point."""
    graph = Graph()
    record = graph.table(np.sin, graph.variable("t"), np.cos)
    own = made(
        lambda t, x, y, m: [record * x, *jacobian([record], [t])[0]],
        by_machine=by_machine, monkeypatch=monkeypatch, graph=graph,
    )  # fmt: skip
    at, state = own.at_point((False,)), np.array([2.0, 0.0])
    assert list(at.values(0.3, state)) == pytest.approx([2 * math.sin(0.3), math.cos(0.3)])
    assert at.slopes(0.3, state) == pytest.approx(np.array([[math.sin(0.3), 0.0], [0.0, 0.0]]))
    t = np.array([0.1, 0.2])
    many = own.at_samples(t, np.ones((2, 2)), (False,))
    assert many == pytest.approx(np.stack([np.sin(t), np.cos(t)]))


@both
def test_roots_at_zero_are_level(by_machine, monkeypatch):
    """A flow that turns has no endless slope."""
    own = made(
        lambda t, x, y, m: [Namespace.sqrt(x), x**0.3, Namespace.sqrt(x) * y],
        by_machine=by_machine, monkeypatch=monkeypatch, graph=Graph(),
    )  # fmt: skip
    at = own.at_point((False,))
    assert at.slopes(0.0, np.array([0.0, 2.0])).tolist() == [[0.0, 0.0]] * 3
    expected = [[0.25, 0.0], [0.3 * 4**-0.7, 0.0], [0.5, 2.0]]
    assert at.slopes(0.0, np.array([4.0, 2.0])) == pytest.approx(np.array(expected))


@both
def test_a_point_without_a_value_is_an_error(by_machine, monkeypatch):
    """The root of a negative number stops an integration; a sample is NaN."""
    own = made(
        lambda t, x, y, m: [x, Namespace.sqrt(y)],
        by_machine=by_machine, monkeypatch=monkeypatch, graph=Graph(),
    )  # fmt: skip
    at, state = own.at_point((False,)), np.array([1.0, -1.0])
    for function in (at.values, at.slopes):
        with pytest.raises((ArithmeticError, ValueError)):
            function(0.5, state)
    assert at.latest().tolist() == [0.5, 1.0, -1.0]
    samples = own.at_samples(np.zeros(2), np.array([[1.0, 1.0], [4.0, -1.0]]), (False,))
    assert samples == pytest.approx(np.array([[1.0, 1.0], [2.0, np.nan]]), nan_ok=True)


@pytest.mark.skipif(not programs.AVAILABLE, reason="the machine was not built")
def test_states_of_the_wrong_kind_are_refused():
    """Strided states are read as they are; another type or number is an error, not other memory."""
    graph = Graph()
    t, x, y = (graph.variable(name) for name in "txy")
    run = program([t, x, y], [x - y + t]).repeated(np.zeros(3), 2)
    assert run(1.0, np.arange(6.0)[1::3]) == pytest.approx([1.0 + 1.0 - 4.0])
    for states in (np.arange(2), np.zeros(3), np.zeros((2, 1)), np.zeros(2, dtype=">f8")):
        with pytest.raises(ValueError, match="states"):
            run(0.0, states)
    for arguments in ((), (1.0,), (1.0, 2.0), ("t", np.zeros(2)), (1.0, None)):
        with pytest.raises(TypeError):
            run(*arguments)


@pytest.mark.skipif(not programs.AVAILABLE, reason="the machine was not built")
@pytest.mark.parametrize(
    ("point", "states", "columns"),
    [
        (2, 2, None),
        (4, 2, None),
        (3, 3, None),
        (3, -1, None),
        (3, 2, [0]),
        (3, 2, [3]),
        (3, 1, [2]),
    ],
)
def test_a_wrong_place_is_refused(point, states, columns):
    """Neither the point nor the columns may lie outside the program's inputs."""
    graph = Graph()
    t, x, y = (graph.variable(name) for name in "txy")
    made = program([t, x, y], [x - y + t])
    with pytest.raises((ValueError, IndexError)):
        made.repeated(np.zeros(point), states, columns)
