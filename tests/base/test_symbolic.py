"""Symbols: a traced model is the model, its derivative is exact, its bounds hold."""

from __future__ import annotations

import ast
import math
from pathlib import Path

import numpy as np
import pytest
from hypothesis import assume, example, given, strategies as st
from model_samples import called, cases, leaves, public_functions

import actuator_opt.simulation.components
from actuator_opt.base import numeric
from actuator_opt.base.symbolic import Graph, Namespace, Symbol, function, jacobian, vectorised

NOT_TRACED = {
    "autofrettage.autofrettage": "chooses by its numbers",
    "barrel.wall_ratio_for_strain": "chooses by its numbers",
    "endurance.miner_damage": "a history of samples",
    "layered_tube.ply_stresses_at_faces": "a matrix of layers",
    "layered_tube.tube_state": "a matrix of layers",
    "layered_tube.tube_stresses": "a matrix of layers",
    "metering_spool.holding_stroke": "iterates",
    "metering_spool.held_slopes": "iterates",
    "lip_seal.line_load": "hyperbolic functions",
    "lip_seal.lip_stiffness": "hyperbolic functions",
    "lip_seal.peak_pressure": "hyperbolic functions",
    "liner.layer_thickness_for_strain": "roots of a polynomial",
    "loop.load_mode": "eigenvalues",
    "loop.margins": "eigenvalues",
    "loop.ultimate_gain": "eigenvalues",
    "one_way_valve.one_way_pressure_drop": "iterates",
    "rainflow.repeating_cycles": "a history of samples",
    "burst_ladder.burst_by_ply_discount": "a matrix of layers",
    "shrink_fit.bore_stress": "a matrix of layers",
    "shrink_fit.outer_growth": "a matrix of layers",
    "rough_surface.asperity_integral": "a table",
    "rough_surface.asperity_pressure": "a table",
    "rough_surface.film_ratio_under_contact": "a table",
    "rough_surface.mean_gap_ratio": "a table",
    "supply_sizing.ripple_volume": "a history of samples",
    "thermal_network.ripple_bound": "a history of samples",
    "tube_burst.burst_of_tube": "a matrix of layers",
    "tube_elements.layered_tube": "a matrix of layers",
    "wear.cycle_severity": "a history of samples",
    "wear.sliding_distance": "a history of samples",
}
"""Models beyond what symbols are for: formulas of the elementary functions."""
LARGE = ("thermal_network.steady_temperatures-0", "thermal_network.steady_temperatures-1")
"""Samples whose Jacobian takes seconds; a third of the same model does not."""
CASES = [
    pytest.param(model, sample, id=label)
    for label, model, sample in cases()
    if label.rsplit("-", 1)[0] not in NOT_TRACED
]
DIFFERENTIATED = [
    pytest.param(*case.values, id=case.id, marks=[pytest.mark.long] if case.id in LARGE else [])
    for case in CASES
]
STEEP = {
    "orifice.orifice_conductance-2": "closed",
    "strength.tsai_wu_modes-8": "no stress",
    "strength_modes.hashin_modes-8": "no stress",
    "strength_modes.puck_modes-7": "no stress",
    "strength_modes.puck_modes-8": "no stress",
    "supply.relief_flow-0": "no pressure difference",
}
"""Samples on a root of zero, whose slope has no end."""


def traced(model, sample):
    """Graph, inputs, numbers and outputs of a model at a sample."""
    numbers = [float(number) for number in leaves(sample)]
    graph = Graph()
    inputs = [graph.variable(f"x{i}") for i in range(len(numbers))]
    return inputs, numbers, called(model, sample, inputs, 0)


def unpacked(inputs):
    """Where the code finds the inputs."""
    return {f"{', '.join(str(one.args[0]) for one in inputs)},": "x"} if inputs else {}


def models_of_the_parts():
    """Models that the parts of a circuit call, by ``module.name``."""
    found = set()
    for path in Path(actuator_opt.simulation.components.__path__[0]).glob("*.py"):
        tree = ast.parse(path.read_text(encoding="utf-8"))
        modules = {}
        for node in ast.walk(tree):
            if isinstance(node, ast.ImportFrom) and node.module and "models" in node.module:
                for one in node.names:
                    modules[one.asname or one.name] = f"{node.module}.{one.name}"
        for node in ast.walk(tree):
            if not isinstance(node, ast.Call):
                continue
            called = node.func
            if isinstance(called, ast.Attribute) and isinstance(called.value, ast.Name):
                name = f"{modules.get(called.value.id, '')}.{called.attr}"
            elif isinstance(called, ast.Name):
                name = modules.get(called.id, "")
            else:
                continue
            found.add(".".join(name.split(".")[-2:]))
    return found & set(public_functions())


def test_models_of_the_parts_are_traced():
    """Every model that a part of a circuit calls is among those compared here."""
    used = models_of_the_parts()
    assert {"valve.valve_flows", "chamber.mixture_bulk_modulus", "lugre.lugre_rate"} <= used
    assert not used & set(NOT_TRACED)


def test_models_that_cannot_be_traced_say_so():
    """Every sample of the models listed fails, at once, and no other."""
    raised = set()
    for label, model, sample in cases():
        try:
            traced(model, sample)
        except (TypeError, AttributeError):
            raised.add(label)
    listed = {label for label, *_ in cases() if label.rsplit("-", 1)[0] in NOT_TRACED}
    assert raised == listed
    assert {label.rsplit("-", 1)[0] for label in listed} == set(NOT_TRACED)


@pytest.mark.parametrize(("model", "sample"), CASES)
def test_code_of_a_model_is_the_model(model, sample):
    """One point in plain Python and many in NumPy: the numbers of the model, to rounding."""
    inputs, numbers, outputs = traced(model, sample)
    ours = function("f", "x", unpacked(inputs), outputs)(numbers)
    theirs = called(model, sample, numbers, 0)
    assert ours == pytest.approx([float(one) for one in theirs], rel=1e-14, nan_ok=True)
    points = np.array(numbers)[:, None] * np.linspace(0.99, 1.01, 5)
    with np.errstate(all="ignore"):  # both branches of a choice are computed
        many = vectorised("f", "x", unpacked(inputs), outputs)(points)
        arrays = called(model, sample, list(points), 1)
    for mine, array in zip(many, arrays, strict=True):
        assert np.broadcast_to(mine, 5) == pytest.approx(
            np.broadcast_to(array, 5), rel=2e-14, nan_ok=True
        )


@pytest.mark.parametrize(("model", "sample"), DIFFERENTIATED)
def test_jacobian_of_a_model_is_its_complex_step(model, sample, request):
    """Exact derivatives in every argument, over the largest effect of an argument."""
    inputs, numbers, outputs = traced(model, sample)
    flat = [slope for row in jacobian(outputs, inputs) for slope in row]
    found = np.array(function("f", "x", unpacked(inputs), flat)(numbers), dtype=float)
    if request.node.callspec.id in STEEP:
        assert not np.any(np.isinf(found))
        return
    size = len(numbers)
    batch = np.repeat(np.array(numbers, dtype=complex)[:, None], size, axis=1)
    batch[np.arange(size), np.arange(size)] += 1j * numeric.STEP
    exact = [np.broadcast_to(np.imag(one), size) for one in called(model, sample, batch, 1)]
    exact = np.array(exact).reshape(len(outputs), size) / numeric.STEP
    effect = np.abs(exact * numbers)
    apart = np.abs((found.reshape(exact.shape) - exact) * numbers)
    limit = 1e-10 if request.node.callspec.id == "rough_surface.shear_stress_factor-1" else 1e-12
    assert np.all((apart <= limit * effect.max(axis=1, keepdims=True)) | np.isnan(exact))


NAMES = ("x", "y", "z")
NUMBERS = st.one_of(
    st.sampled_from([0.0, 1.0, -1.0, 2.0, 0.5, -3.0]),
    st.floats(-4, 4, allow_nan=False, allow_subnormal=False),
)
LEAVES = st.one_of(st.sampled_from(NAMES), NUMBERS)


def _grown(inner):
    two = st.tuples(st.sampled_from(["+", "-", "*", "/", "max", "min", "atan2"]), inner, inner)
    one = st.tuples(
        st.sampled_from(["neg", "abs", "sqrt", "exp", "expm1", "tanh", "sin", "cos", "log1p"]),
        inner,
    )
    raised = st.tuples(st.just("**"), inner, st.sampled_from([0, 0.5, 1, 1.5, 2, 3, -1, -2]))
    limited = st.tuples(st.just("clip"), inner, st.floats(-2, 0), st.floats(0, 2))
    comparison = st.sampled_from(["<", "<=", ">", ">="])
    chosen = st.tuples(st.just("where"), comparison, inner, inner, inner, inner)
    both = st.tuples(st.just("both"), st.sampled_from("&|~"), inner, inner, inner, inner)
    return st.one_of(two, one, raised, limited, chosen, both)


TREES = st.recursive(LEAVES, _grown, max_leaves=14)
COMPARED = {
    "<": lambda a, b: a < b,
    "<=": lambda a, b: a <= b,
    ">": lambda a, b: a > b,
    ">=": lambda a, b: a >= b,
}


def built(tree, known, seen=None):
    """Value of a tree with symbols or with numbers."""
    if isinstance(tree, str):
        return known[tree]
    if isinstance(tree, float | int):
        return tree
    op, *parts = tree
    if op in ("where", "both"):
        word, parts = parts[0], parts[1:]
    values = [built(part, known, seen) for part in parts]
    symbolic = any(isinstance(value, Symbol) for value in known.values())
    result = _applied(op, word if op in ("where", "both") else "", values, symbolic)
    if seen is not None:
        seen.append(result)
    return result


def _applied(op, word, values, symbolic):
    a, b = values[0], values[1] if len(values) > 1 else None
    simple = {
        "+": lambda: a + b,
        "-": lambda: a - b,
        "*": lambda: a * b,
        "/": lambda: a / b,
        "**": lambda: a**b if isinstance(a, Symbol) else math.pow(a, b),
        "neg": lambda: -a,
        "max": lambda: numeric.maximum(a, b),
        "min": lambda: numeric.minimum(a, b),
        "abs": lambda: numeric.absolute(a),
        "clip": lambda: numeric.clip(*values),
    }
    if op in simple:
        return simple[op]()
    if op == "where":
        return numeric.where(COMPARED[word](a, b), values[2], values[3])
    if op == "both":
        first, second = a < b, values[2] <= values[3]
        if word == "~":
            left = ~first if isinstance(first, Symbol) else not first
            return numeric.where(left, a, values[2])
        return numeric.where(first & second if word == "&" else first | second, a, b)
    if op == "atan2":
        return Namespace.atan2(a, b) if symbolic else math.atan2(a, b)
    return getattr(Namespace if symbolic else math, op)(a)


POINTS = st.fixed_dictionaries(
    {name: st.one_of(st.sampled_from([0.0, 1.0, -1.0]), st.floats(-5, 5)) for name in NAMES}
)


def plain(tree, point):
    """Value of a tree at a point, where it and all its parts are numbers of usual size."""
    seen = []
    try:
        value = built(tree, point, seen)
    except (ArithmeticError, ValueError):
        return None
    usual = all(one == one and (abs(one) < 1e100) for one in [value, *seen])
    return value if usual and all(one == 0 or abs(one) > 1e-100 for one in [value, *seen]) else None


@given(tree=TREES, points=st.lists(POINTS, min_size=4, max_size=4))
@example(tree=("where", "<", ("*", "x", "x"), 0.0, 1.0, 2.0), points=[dict.fromkeys(NAMES, 0.0)])
@example(tree=("max", ("-", "x", "y"), 0.0), points=[{"x": 1.0, "y": 3.0, "z": 0.0}])
def test_folding_and_bounds_hold_wherever_the_expression_does(tree, points):
    """The code gives the tree's value, and every node stays within the bounds it claims."""
    graph = Graph()
    try:
        expression = built(tree, {name: graph.variable(name) for name in NAMES})
    except (ArithmeticError, ValueError):  # a part without symbols has no value
        assume(False)
    unpack = {name: f"p[{name!r}]" for name in NAMES}
    numbers = [node for node in graph.nodes if node.op not in ("lt", "le", "and", "or", "not")]
    truths = [node for node in graph.nodes if node not in numbers]
    code = function("f", "p", unpack, [expression])
    many = vectorised("g", "p", unpack, [*numbers, *truths])
    for point in points:
        expected = plain(tree, point)
        if expected is None:
            continue
        scale = max([abs(expected), *(abs(one) for one in _parts(tree, point))])
        assert code(point)[0] == pytest.approx(expected, rel=1e-9, abs=1e-11 * scale)
        with np.errstate(all="ignore"):
            values = many({name: np.float64(value) for name, value in point.items()})
        for node, value in zip(numbers, values, strict=False):
            low, high = node.bounds
            assert not value < low, node
            assert not value > high, node


def _parts(tree, point):
    seen = []
    built(tree, point, seen)
    return seen


@given(tree=TREES, point=POINTS)
def test_jacobian_of_any_expression_is_a_difference(tree, point):
    """Where an expression is smooth its derivatives are its central differences."""
    graph = Graph()
    try:
        symbols = [graph.variable(name) for name in NAMES]
        expression = built(tree, dict(zip(NAMES, symbols, strict=True)))
    except (ArithmeticError, ValueError):
        assume(False)
    unpack = {name: f"p[{name!r}]" for name in NAMES}
    offsets = zip(point.items(), (1.1e-3, 1.7e-3, 2.3e-3), strict=True)
    point = {name: value + offset for (name, value), offset in offsets}  # branches do not touch
    rows = jacobian([expression], symbols)
    found = {}
    for name, slope in zip(NAMES, rows[0], strict=True):
        differences = []
        for step in (1e-4, 1e-5):
            ends = [plain(tree, point | {name: point[name] + s * step}) for s in (1, 0, -1)]
            assume(None not in ends)
            differences.append((ends[0] - ends[2]) / (2 * step))
            bent = (ends[0] - 2 * ends[1] + ends[2]) / step
            assume(abs(bent) < 1e-2 * max(1.0, abs(differences[-1])))  # a kink is close
        assume(abs(differences[0] - differences[1]) < 1e-5 * max(1.0, abs(differences[1])))
        found[name] = slope, differences[1]
    code = function("f", "p", unpack, [slope for slope, _ in found.values()])
    try:
        slopes = code(point)
    except (ArithmeticError, ValueError):
        assume(False)
    for slope, (_, difference) in zip(slopes, found.values(), strict=True):
        assume(slope == slope)
        scale = max([1.0, *(abs(one) for one in _parts(tree, point))])
        assert slope == pytest.approx(difference, rel=2e-4, abs=1e-4 * scale)


@pytest.fixture
def graph():
    """Return an empty graph."""
    return Graph()


def test_numbers_are_worked_out_at_once(graph):
    """Operations on numbers, and those whose result no symbol can change, leave no node."""
    x = graph.variable("x")
    before = len(graph.nodes)
    assert Namespace.sqrt(4.0) == 2.0
    assert x * 0 == 0.0
    assert 0.0 / (x * x + 1) == 0.0
    assert x + 0 is x
    assert x * 1 is x
    minus = -x
    assert -minus is x
    assert x - x == 0.0
    assert x**1 is x
    assert Namespace.where(True, x, 1.0) is x
    assert Namespace.where(x > 0, 3.0, 3.0) == 3.0
    assert len(graph.nodes) < before + 8


def test_equal_operations_are_one_node(graph):
    """Sums and products in either order, and whole models called twice, are the same node."""
    x, y = graph.variable("x"), graph.variable("y")
    assert x + y is y + x
    assert x * y is y * x
    assert x - y is not y - x
    assert graph.variable("x") is x
    assert Namespace.exp(x * y + 1) is Namespace.exp(1 + y * x)
    model = public_functions()["valve.edge_flow"]
    first = model(coefficient=1e-7, pressure_drop=x - y)
    count = len(graph.nodes)
    assert model(coefficient=1e-7, pressure_drop=x - y) is first
    assert len(graph.nodes) == count


def test_bounds_decide_comparisons(graph):
    """A square is not negative, a limited signal stays within its limits, a NaN has no bounds."""
    x = graph.variable("x")
    assert (x * x < 0) is False
    assert (x * x >= 0) is True
    assert (numeric.clip(x, -10.0, 10.0) > 10) is False
    assert (numeric.clip(x, -10.0, 10.0) >= 10) is not False
    assert (Namespace.sqrt(x * x + 4) < 2) is False
    assert isinstance(x < math.nan, Symbol)
    assert isinstance(numeric.positive(x) > 0, Symbol)
    assert function("f", "x", {"x": "x"}, [numeric.where(x < math.nan, 1.0, 2.0)])(0.0) == [2.0]


def test_nan_and_infinity_stand_in_the_code(graph):
    """Numbers that have no literal are written all the same."""
    x = graph.variable("x")
    choice = numeric.where(x > 0, x, math.nan)
    high, low = numeric.where(x > 0, x, math.inf), numeric.where(x > 0, x, -math.inf)
    outputs = [choice, high, low, math.nan, -math.inf, True, -0.0]
    found = function("f", "x", {"x": "x"}, outputs)(-1.0)
    assert found == pytest.approx(
        [math.nan, math.inf, -math.inf, math.nan, -math.inf, True, 0.0], nan_ok=True
    )
    many = vectorised("f", "x", {"x": "x"}, [choice])(np.array([-1.0, 2.0]))
    np.testing.assert_array_equal(many[0], [math.nan, 2.0])


def test_flags_and_truths(graph):
    """And, or and not of flags and comparisons, at a point and at many."""
    x, on, off = graph.variable("x"), graph.flag("m_0"), graph.flag("m_1")
    truths = [on & (x > 0), on | off, ~on, ~(on & ~off) | (x <= 0), ~~on]
    outputs = [numeric.where(truth, 1.0, 0.0) for truth in truths]
    unpack = {"x": "x", "m_0, m_1": "m"}
    point = function("f", "x, m", unpack, outputs)
    many = vectorised("f", "x, m", unpack, outputs)
    assert truths[4] is on
    for value in (-1.0, 1.0):
        for a in (False, True):
            for b in (False, True):
                expected = [a and value > 0, a or b, not a, not (a and not b) or value <= 0, a]
                assert point(value, (a, b)) == expected
                flags = np.array([[a], [b]])
                found = [one[0] for one in many(np.array([value]), flags)]
                assert found == expected
    with pytest.raises(TypeError, match="where"):
        assert x > 0


def test_tables_and_their_slopes(graph):
    """A looked-up function of time is called as it is; its slope is the one that was given."""
    t, x = graph.variable("t"), graph.variable("x")
    looked = graph.table(np.sin, 2 * t, np.cos)
    level = graph.table(np.cos, t)
    outputs = [looked * x, *jacobian([looked * x, level], [t, x])[0]]
    outputs += jacobian([level], [t])[0]
    found = function("f", "t, x", {"t": "t", "x": "x"}, outputs)(0.3, 2.0)
    assert found == pytest.approx(
        [2 * math.sin(0.6), 4 * math.cos(0.6), math.sin(0.6), 0.0], rel=1e-15
    )
    many = vectorised("f", "t, x", {"t": "t", "x": "x"}, outputs[:1])
    assert many(np.array([0.3, 0.4]), 1.0)[0] == pytest.approx(np.sin([0.6, 0.8]))


def test_roots_at_zero_are_level(graph):
    """Where the slope of a root has no end a derivative is zero, never an exception."""
    x = graph.variable("x")
    roots = [Namespace.sqrt(x), x**0.3, Namespace.sqrt(numeric.maximum(x, 0.0)) * x]
    rows = [row[0] for row in jacobian(roots, [x])]
    code = function("f", "x", {"x": "x"}, rows)
    assert code(0.0) == [0.0, 0.0, 0.0]
    assert code(4.0) == pytest.approx([0.25, 0.3 * 4**-0.7, 3.0], rel=1e-15)


def test_deep_expressions_compile(graph):
    """Thousands of operations in one another, and a name that looks like a line of code."""
    x, v = graph.variable("x"), graph.variable("v5")
    deep = x
    for k in range(3_000):
        deep = Namespace.sin(deep) + v if k % 3 else deep * 0.5
    expected = 0.7
    for k in range(3_000):
        expected = math.sin(expected) + 0.2 if k % 3 else expected * 0.5
    unpack = {"x, v5": "p"}
    assert function("f", "p", unpack, [deep])((0.7, 0.2)) == pytest.approx([expected], rel=1e-12)
    slopes = function("f", "p", unpack, jacobian([deep], [x, v])[0])((0.7, 0.2))
    assert all(math.isfinite(slope) for slope in slopes)


def test_numpy_numbers_and_symbols_mix(graph):
    """A NumPy number before or after a symbol leaves the operation to the symbol."""
    x = graph.variable("x")
    two = np.float64(2.0)
    outputs = [two * x, x * two, two - x, two / x, x / np.int64(4), np.array(3.0) + x]
    assert all(isinstance(one, Symbol) for one in outputs)
    truth = numeric.where(np.bool_(True) & (x > two), 1.0, 0.0)
    found = function("f", "x", {"x": "x"}, [*outputs, truth])(8.0)
    assert found == [16.0, 16.0, -6.0, 0.25, 2.0, 11.0, 1.0]
