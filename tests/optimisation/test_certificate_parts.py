"""Parts of the certificate on problems that have nothing to do with actuators."""

from __future__ import annotations

import math
import warnings

import cvxpy as cp
import numpy as np
import pytest
from hypothesis import assume, given, strategies as st

from actuator_opt.base.symbolic import Graph
from actuator_opt.base.symbolic.expression import Namespace
from actuator_opt.optimisation.certificate.bounding import Bounding, add_plain_sums
from actuator_opt.optimisation.certificate.builder import Builder
from actuator_opt.optimisation.certificate.certify import BoxSearch
from actuator_opt.optimisation.certificate.intervals import Box, Layout, narrow, tighten
from actuator_opt.optimisation.certificate.relaxation import (
    SHAPES,
    CurveFunctions,
    Form,
    Relaxation,
    SampledFunction,
    Signomial,
    Tables,
    Unknown,
)

ROUNDING = 1e-9
KNOWN = -83.2497
"""Optimum of `published` [Maranas1997]."""
ABOVE = 200.0
"""Added to its objective, which must be positive here."""


def published(best):
    """Minimise x1/(2 x2) - x1 - 5/x2, x2/(100 x3) + x1/100 + x1 x3/2000 <= 1 [Maranas1997]."""
    graph = Graph()
    x1 = graph.variable("x1", (70.0, 150.0))
    x2 = graph.variable("x2", (1.0, 30.0))
    x3 = graph.variable("x3", (0.5, 21.0))
    objective = ABOVE + 0.5 * x1 / x2 - x1 - 5 / x2
    limit = 0.01 * x2 / x3 + 0.01 * x1 + 0.0005 * x1 * x3
    narrow(limit, (-math.inf, 1.0))
    narrow(objective, (1.0, best))
    tighten(graph.nodes)
    builder = Builder()
    builder.at_least(1.0, limit)
    _, form = builder.form(objective)
    add_plain_sums(builder.relaxation)
    return builder, form


@pytest.fixture(scope="module")
def problem():
    """The published problem as a relaxation."""
    builder, form = published(ABOVE + KNOWN + 1.0)
    return Layout(builder.relaxation), form


def test_published_optimum_is_proven(problem):
    """The bound of the published problem closes on its known optimum, and is not above it."""
    layout, form = problem
    best = math.log(ABOVE + KNOWN)
    found = BoxSearch(layout, Bounding(layout, form), best, max_boxes=400).run()
    assert found.closed
    assert math.exp(found.bound) == pytest.approx(ABOVE + KNOWN, rel=2e-4)
    assert math.exp(found.bound) <= ABOVE + KNOWN


def test_a_better_design_that_does_not_exist_is_not_found(problem):
    """Given a worse best known value, the bound still is not above the true optimum."""
    layout, form = problem
    best = math.log(ABOVE + KNOWN + 1.0)
    found = BoxSearch(layout, Bounding(layout, form), best, max_boxes=60).run()
    assert math.exp(found.bound) <= (ABOVE + KNOWN) * (1 + 1e-6)


def wide():
    """Minimise x y + z with x + y >= 3 and x z + y/z >= 4: as a relaxation over a wide box."""
    graph = Graph()
    x, y, z = (graph.variable(name, (0.2, 8.0)) for name in "xyz")
    objective, first, second = x * y + z, x + y, x * z + y / z
    tighten(graph.nodes)
    builder = Builder()
    builder.at_least(first, 3.0)
    builder.at_least(second, 4.0)
    _, form = builder.form(objective)
    layout = Layout(builder.relaxation)
    box = Box.whole(layout).tightened(layout)
    builder.relaxation.lower, builder.relaxation.upper = box.lower.tolist(), box.upper.tolist()
    add_plain_sums(builder.relaxation)
    return Layout(builder.relaxation), form


def relaxed_by_cvxpy(layout, box, objective):
    """Optimum of the same convex relaxation by an interior-point method."""
    relaxation = layout.relaxation
    y = cp.Variable(layout.atoms)

    def of(form):
        return form.constant + sum(power * y[i] for i, power in form.powers)

    rules = [y >= box.lower, y <= box.upper]
    rules += [of(row.low) <= of(row.high) for row in relaxation.rows]
    low, high = layout.arguments(box.low, box.high)
    functions = {"softplus": cp.logistic, "exp": cp.exp}
    for k, curve in enumerate(relaxation.curves):
        argument, out = of(curve.argument), of(curve.out)
        rules += [argument >= low[k], argument <= high[k]]
        value = SHAPES[curve.kind].value
        rules.append(functions[curve.kind](argument) <= out)
        first, last = value(low[k]), value(high[k])
        slope = (last - first) / (high[k] - low[k]) if high[k] > low[k] else 0.0
        rules.append(out <= max(first, last) - slope * (high[k] - argument))
    least, most = layout.ratios(box)
    for k, link in enumerate(relaxation.links):
        rules += [y[link.out] >= least[k] * y[link.base], y[link.out] <= most[k] * y[link.base]]
    for one in relaxation.products:
        first, second, out = y[one.first], y[one.second], y[one.out] * math.exp(-one.level)
        (a, b), (c, d) = ((box.lower[i], box.upper[i]) for i in (one.first, one.second))
        rules += [out >= a * second + c * first - a * c, out >= b * second + d * first - b * d]
        rules += [out <= b * second + c * first - b * c, out <= a * second + d * first - a * d]
    with warnings.catch_warnings():  # it doubts its last digits; the test asks for three
        warnings.simplefilter("ignore", UserWarning)
        return cp.Problem(cp.Minimize(of(objective)), rules).solve(solver=cp.CLARABEL)


def test_bound_is_never_above_that_of_another_solver():
    """The safe bound of a part is at most, and close to, an interior-point optimum."""
    layout, form = wide()
    rng = np.random.default_rng(0)
    bounding = Bounding(layout, form)
    root = Box.whole(layout).tightened(layout)
    bounding.add_first_tangents(root)
    for _ in range(6):
        box = root
        for _ in range(int(rng.integers(0, 6))):
            number = int(rng.integers(layout.directions))
            middle = (box.low[number] + box.high[number]) / 2
            box = box.split(number, middle)[int(rng.integers(2))]
        exact = relaxed_by_cvxpy(layout, box, form)
        bounding.refine(0.0)
        for _ in range(8):  # each adds tangents
            bound = bounding.solve(box)
        if bound is None:
            assert exact == math.inf
            continue
        assert bound.value <= exact + 1e-6
        if math.isfinite(exact):
            assert bound.value == pytest.approx(exact, abs=2e-3)


@given(st.floats(-30, 30), st.floats(0, 30), st.floats(0, 1), st.sampled_from(sorted(SHAPES)))
def test_chord_and_tangent_enclose_a_curve(low, width, share, name):
    """Every curve lies between its chord and its tangents, and in its hull."""
    low, high = (low, low + width) if name != "log" else (0.1 + abs(low), 0.1 + abs(low) + width)
    if name == "tanh":
        low, high = low / 10, high / 10
    t = low + share * (high - low)
    assume(t <= high)
    shape = SHAPES[name]
    value = float(shape.value(np.array(t)))
    first, last = (float(shape.value(np.array(end))) for end in (low, high))
    chord = first + share * (last - first)
    off = shape.convex * (chord - value)
    assert off >= -ROUNDING * (1 + abs(value) + abs(last))
    for at in (low, high):
        tangent = float(shape.value(np.array(at)) + shape.slope(np.array(at)) * (t - at))
        size = 1 + abs(value) + abs(tangent) + abs(last)
        assert shape.convex * (value - tangent) >= -ROUNDING * size
    least, most = CurveFunctions([name]).hull(np.array([low]), np.array([high]))
    assert least[0] - ROUNDING * (1 + abs(least[0])) <= value
    assert value <= most[0] + ROUNDING * (1 + abs(most[0]))


@given(st.floats(0.2, 3), st.floats(-3, 3), st.floats(0, 1), st.floats(0, 1), st.floats(0, 1))
def test_a_table_encloses_what_it_samples(rate, phase, first, second, share):
    """A table has the value within its room, and its line and hull enclose it over any range."""
    t = np.linspace(-1.0, 2.0, 1001)

    def wave(x):
        return np.sin(rate * x + phase)

    # beside it two that only rise: one with a flat end, one constant
    def flattening(x):
        return 1 - np.maximum(1 - x, 0.0) ** 3

    others = [flattening(t), np.full_like(t, 0.5)]
    tables = Tables([SampledFunction.of(t, values, 1.5) for values in (wave(t), *others)])
    low, high = sorted((-1 + 3 * first, -1 + 3 * second))
    x = low + share * (high - low)
    every = np.ones(3)
    true = np.array([float(wave(x)), float(flattening(x)), 0.5])
    room = tables.room + ROUNDING
    assert (np.abs(tables.value(x * every) - true) <= room).all()
    least, most = tables.hull(low * every, high * every)
    assert (least - ROUNDING <= true).all()
    assert (true <= most + ROUNDING).all()
    slope = 0.3
    start = tables.value(low * every)
    below, above = tables.secant_errors(low * every, high * every, slope * every, tables.rows)
    line = start + slope * (x - low)
    assert (line + below - room <= true).all()
    assert (true <= line + above + room).all()
    inner = tables.inverse_hull(true, true)
    assert (inner[0] - 1e-6 <= x).all()
    assert (x <= inner[1] + 1e-6).all()


VALUE = st.floats(0.1, 10.0)


@given(VALUE, VALUE, VALUE)
def test_signomials_are_what_they_stand_for(a, b, c):
    """Sums, products and quotients by forms have the value of the plain expression."""
    logs = np.log([a, b, c])

    def at(one):
        total = 0.0
        for powers, factor in one.terms.items():
            total += factor * math.exp(Form(0.0, powers).at(logs))
        return total

    x, y, z = (Signomial.monomial(1.0, Form(0.0, ((i, 1.0),))) for i in range(3))
    whole = x.plus(y).times(x.plus(z, -1.0)).plus(Signomial.number(2.0))
    assert at(whole) == pytest.approx((a + b) * (a - c) + 2.0, abs=1e-9)
    assert at(x.plus(y).plus(x, -1.0)) == pytest.approx(b)
    assert len(x.plus(y).plus(x, -1.0).terms) == 1


@given(st.tuples(VALUE, VALUE), st.tuples(VALUE, VALUE), st.tuples(*[st.floats(0, 1)] * 2))
def test_what_meets_a_limit_stays_in_the_bounds(first, second, shares):
    """Propagation keeps every point of the box that meets the limit, and its values."""
    graph = Graph()
    (a, b), (c, d) = sorted(first), sorted(second)
    x, y = graph.variable("x", (a, b)), graph.variable("y", (c, d))
    value = (x * x + 3 / y) / (x + y)
    p, q = a + shares[0] * (b - a), c + shares[1] * (d - c)
    there = (p * p + 3 / q) / (p + q)
    narrow(value, (-math.inf, there))
    tighten(graph.nodes)
    for symbol, number in ((x, p), (y, q), (value, there)):
        low, high = symbol.bounds
        assert low * (1 - 1e-8) <= number <= high * (1 + 1e-8)


@given(VALUE, VALUE, VALUE, st.floats(0.5, 3))
def test_atoms_follow_their_expression(a, b, c, power):
    """Makers give every atom the logarithm of its value: the curves hold where they meet."""
    graph = Graph()
    x, y, z = (graph.variable(name, (0.05, 20.0)) for name in "xyz")
    value = (x + y**power) * z + 1 / (x + 2 * z)
    tighten(graph.nodes)
    builder = Builder()
    sign, form = builder.form(value)
    names = {one.powers[0][0]: name for name, one in builder.variables.items()}
    at = dict(zip("xyz", (a, b, c), strict=True))
    logs: list[float] = []
    for i, maker in enumerate(builder.relaxation.makers):
        logs.append(math.log(at[names[i]]) if i in names else maker(logs))
    assert sign == 1.0
    assert math.exp(form.at(logs)) == pytest.approx((a + b**power) * c + 1 / (a + 2 * c))
    for curve in builder.relaxation.curves:
        found = float(SHAPES[curve.kind].value(np.array(curve.argument.at(logs))))
        assert found == pytest.approx(curve.out.at(logs), abs=1e-9)


def test_atoms_of_a_steep_sampled_function_are_exact():
    """Cycles of a fatigue line, (s/(1 - s/R))^-11, at a stress between two samples.

    The interpolation there is off by more than the tolerance of a limit, 1e-6, so that a design
    on its limit would seem to miss it.
    """
    graph = Graph()
    stress = graph.variable("s", (0.05, 0.8))
    ratio = stress / (1.0 - stress)
    life = Namespace.exp(-11.0 * Namespace.log(ratio))
    tighten(graph.nodes)
    builder = Builder()
    _, form = builder.form(life)
    at = math.log(0.34567)
    logs = [at, builder.relaxation.makers[1]([at])]
    assert form.at(logs) == pytest.approx(-11 * math.log(0.34567 / (1 - 0.34567)), abs=1e-12)
    (curve,) = builder.relaxation.curves
    between = float(Tables([curve.kind]).value(np.array([at]))[0])
    assert 1e-6 < abs(between - form.at(logs)) <= curve.kind.room


def test_an_open_sign_is_said():
    """A difference that may be zero has no logarithm."""
    graph = Graph()
    x, y = graph.variable("x", (1.0, 2.0)), graph.variable("y", (1.0, 2.0))
    with pytest.raises(Unknown, match="subtraction whose result may be"):
        Builder().form(x - y)


def test_a_direction_is_no_longer_than_its_atoms():
    """A small power of a first atom does not make a direction leave what ranges can hold."""
    found = Relaxation()
    x, y = (found.atom(1e-4, 1e4, lambda _: math.nan) for _ in range(2))
    found.total([x.scaled(0.01) + y.scaled(2.0), Form(0.0)], 0.0, math.inf)
    layout = Layout(found)
    box = Box.whole(layout).tightened(layout)
    assert (box.upper[:2] >= math.log(1e4) - ROUNDING).all()


def test_rounding_of_a_sum_cuts_nothing():
    """What is left of a sum is known to the rounding of its larger part only."""
    graph = Graph()
    x = graph.variable("x", (0.0, 1e-9))
    whole = x + 3e-6
    value = 2.9e-21
    narrow(whole, (3e-6 + value, 1.0))
    tighten(graph.nodes)
    assert x.bounds[0] <= value
