"""Prices through the actuator's own layer, known multipliers, other valleys, and how it is told."""

from dataclasses import replace
from pathlib import Path
from time import process_time

import numpy as np
import problems
import pytest
import report_fixture as fixture
import yaml
from cli_runner import BENCH
from report_fixture import overlaps

import actuator_opt as ao
from actuator_opt import api as verbs
from actuator_opt.design.model import Limit
from actuator_opt.evaluation import prepare
from actuator_opt.evaluation.plugin import collect
from actuator_opt.optimisation import actuator as actuator_module
from actuator_opt.optimisation.actuator import build
from actuator_opt.optimisation.price_table import ranked, sensitivities
from actuator_opt.optimisation.prices import prices
from actuator_opt.optimisation.problem import BoxProblem, ParametricProblem, PointValues
from actuator_opt.optimisation.resolve import ladder
from actuator_opt.optimisation.solver import solve
from actuator_opt.pages import prices as told
from actuator_opt.pages.prices import tornado
from actuator_opt.rendering import text
from actuator_opt.rendering.blocks import Notes

DESIGNS = Path(__file__).parents[2] / "designs"


def parametric(problem, names, values, evaluate):
    """A problem with parameters, its own evaluation left as it is."""
    return ParametricProblem(problem, names, np.array(values), evaluate)


def test_rosen_suzuki_prices_are_its_multipliers():
    """Raising the right-hand sides 8, 10, 5 lowers f by the published multipliers 1, 0, 2."""
    base, limits = problems.rosen_suzuki(), [8.0, 10.0, 5.0]

    def evaluate(x, p):
        values = base.evaluate(x)
        shift = np.stack(np.broadcast_arrays(*[p[i] - limits[i] + 0 * x[0] for i in range(3)]))
        return PointValues(values.objective, values.constraints + shift)

    rows = prices(parametric(base, ("a", "b", "c"), limits, evaluate), solve(base), change=1e-3)
    assert [row.price for row in rows] == pytest.approx([-1, 0, -2], abs=1e-8)
    for row in rows:
        slope = (row.resolved_up - row.resolved_down) / (2e-3 * row.value)
        assert slope == pytest.approx(row.price, abs=1e-4)


MOVED = (
    "cylinder.bore", "rod.outer_diameter", "barrel.layup[0].thickness", "barrel.layup[1].thickness",
)  # fmt: skip


@ao.metric("stiffness_rest", dimension="stiffness", label="stiffness less 10 kN/mm")
def stiffness_rest(design):
    """A metric in N/m with the natural limit 0."""
    return design.metric("stiffness_min") - 10e6


def knee(requirement, limit):
    """The problem of the knee with four variables and the stiffness limited in some way."""
    data = yaml.load((DESIGNS / "knee.yaml").read_text("utf-8"), Loader=yaml.BaseLoader)
    del data["requirements"]["stiffness_min"]
    data["requirements"][requirement] = {"min": limit}
    data["variables"] = {path: data["variables"][path] for path in MOVED}
    text = yaml.safe_dump(data, sort_keys=False)
    return build(ao.read(text, plugins=(stiffness_rest,)).subject())


def priced(actuator):
    """Solution, prices by two parameters, and processor time of the prices."""
    solution, begin = solve(actuator.problem), process_time()
    asked = actuator.parametric(("supply.pressure", "requirements.seal_gap.max"))
    return solution, prices(asked, solution, bounds=False, change=0.02), process_time() - begin


def test_a_limit_of_zero_is_scaled_in_the_solver():
    """Its row has the size of a relative margin; once the limit is not 0, it is relative to it."""
    actuator = knee("stiffness_rest", "0")
    index = [row.limit_of.metric for row in actuator.rows].index("stiffness_rest")
    start, rest = actuator.problem.start[:, None], float(actuator.rows[index].value[0])
    assert abs(rest) > 1e5
    row = actuator.evaluate(start).constraints[index, 0]
    assert row == pytest.approx(0.5 if rest > 0 else -1)  # m/(1 + m) of m = 1
    numbers = {"requirements.stiffness_rest.min": np.array([2 * abs(rest)])}
    row = actuator.evaluate(start, numbers).constraints[index, 0]
    assert row == pytest.approx(-0.5 if rest > 0 else -1.5)


@pytest.mark.long
def test_a_limit_of_zero_in_large_units_has_the_same_prices():
    """Stiffness - 10 kN/mm >= 0 is stiffness >= 10 kN/mm: optimum, prices, re-solved designs."""
    plain, wanted, _ = priced(knee("stiffness_min", "10 kN/mm"))
    zero, found, seconds = priced(knee("stiffness_rest", "0"))
    assert zero.objective == pytest.approx(plain.objective, rel=1e-12)
    for row, other in zip(found, wanted, strict=True):
        assert row.price == pytest.approx(other.price, rel=1e-3)
        assert row.resolved_up == pytest.approx(other.resolved_up, rel=1e-9)
        assert row.resolved_down == pytest.approx(other.resolved_down, rel=1e-9)
    assert seconds < 5


def test_hs71_price_is_its_multiplier():
    """Asking for a larger product than 25 costs the published multiplier 0.552294 per unit."""
    base = problems.hs71()

    def evaluate(x, p):
        values = base.evaluate(x)
        return PointValues(values.objective, values.constraints + 25 - p[0], values.equalities)

    found = prices(parametric(base, ("product",), [25.0], evaluate), solve(base), bounds=False)
    assert found[0].price == pytest.approx(0.552294, abs=1e-6)


def test_both_sides_of_a_kink_are_what_re_solving_finds():
    """At a >= p, a >= 2 with p = 2 the re-solved slopes at +-0.1 % are the one-sided prices."""

    def evaluate(x, p):
        return PointValues(x[0] + 0 * p[0], np.stack([x[0] - p[0], x[0] - 2 + 0 * p[0]]))

    problem = BoxProblem(
        ("a",),
        np.array([0.1]),
        np.array([10.0]),
        lambda x: evaluate(x, np.array([[2.0]])),
        ("p", "two"),
    )
    asked = parametric(problem, ("p",), [2.0], evaluate)
    (row,) = prices(asked, solve(problem), change=1e-3)
    assert (row.resolved_up - 2) / 2e-3 == pytest.approx(row.price_up, abs=1e-3)
    assert row.price_up == pytest.approx(1)
    assert (2 - row.resolved_down) / 2e-3 == pytest.approx(row.price_down, abs=1e-3)


def test_another_valley_takes_over():
    """Two valleys, at x = 1 with f = p and at x = 3 with f = 2 + p/4: from p = 8/3 the second.

    At p = 2.5 the first is best; at +10 % it costs 2.75, the second 2 + 2.75/4 = 2.6875.
    """

    def evaluate(x, p):
        first, second = (x[0] - 1) ** 2, (x[0] - 3) ** 2
        near = second / (first + second)
        return PointValues(near * p[0] + (1 - near) * (2 + p[0] / 4) + 5 * first * second, None)

    problem = BoxProblem(
        ("x",), np.array([0.2]), np.array([5.0]), lambda x: evaluate(x, np.array([[2.5]]))
    )
    found = solve(problem, more_starts=[np.array([3.05])])
    assert sorted(one.objective for one in found.optima) == pytest.approx([2.5, 2.625])
    (row,) = prices(parametric(problem, ("p",), [2.5], evaluate), found)
    assert row.predicted_up == pytest.approx(2.75)
    assert row.resolved_up == pytest.approx(2 + 2.75 / 4, rel=1e-9)
    assert row.resolved_down == pytest.approx(2.25, rel=1e-9)


@pytest.fixture(scope="module")
def bench():
    """The problem of the bench design and its optimum."""
    actuator = build(verbs.read(BENCH).subject())
    return actuator, solve(actuator.problem, starts=2, samples=2048)


def test_elasticities_of_densities_are_shares_of_mass(bench):
    """The elasticity of a density is the share of mass made of it, and their sum is 1 (Euler).

    Mass is linear in every density and no limit of the bench design reads one.
    """
    actuator, best = bench
    numbers = actuator.subject.numbers
    paths = tuple(
        path
        for path in numbers
        if path.startswith("materials.") and path.endswith(".density") and "iso_vg" not in path
    )
    rows = prices(actuator.parametric(paths), best, bounds=False, resolve=False)
    assert sum(row.percent_per_percent for row in rows) == pytest.approx(1, abs=1e-9)
    for row in rows:
        doubled = actuator.evaluate(best.x[:, None], {row.parameter: np.array([2 * row.value])})
        share = float(np.squeeze(doubled.objective)) / best.objective - 1
        assert row.percent_per_percent == pytest.approx(share, abs=1e-9)


def test_re_solved_end_is_the_optimum_of_a_search_of_its_own():
    """Steel baseline, buckling +10 %: what many starts find, which a stopped descent misses."""
    actuator = build(verbs.read(DESIGNS / "steel_baseline.yaml").subject())
    best = solve(actuator.problem, starts=3, samples=1024)
    asked = actuator.parametric(("requirements.buckling_factor.min",))
    (row,) = prices(asked, best, bounds=False)
    search = solve(asked.at(1.1 * asked.parameters), starts=3, samples=1024, seed=1)
    assert search.feasible
    assert row.resolved_up == pytest.approx(search.objective, rel=1e-8)


def test_rows_are_ranked_by_what_they_change():
    """The largest re-solved change leads, whatever the price says."""
    best = fixture.build_optimisation()
    wild = replace(best.sensitivities[-1], percent_per_percent=50.0)
    assert ranked([wild, best.sensitivities[0]], best.objective_value)[0] is best.sensitivities[0]


def test_straight_only_where_the_price_tells_both_ends():
    """A lost end or one that misses a quarter of the change is no straight line."""
    row = fixture.build_optimisation().sensitivities[0]
    base = replace(row, predicted_10=1.1, predicted_minus10=0.9)
    assert replace(base, resolved_10=1.12, resolved_minus10=0.91).straight(1.0)
    assert not replace(base, resolved_10=1.2, resolved_minus10=0.91).straight(1.0)
    assert not replace(base, resolved_10=None, resolved_minus10=0.91).straight(1.0)


def test_what_buys_the_most():
    """By hand: 205.2 - 190.4 = 14.8 g for stiffness, 7.9 g for pressure, nothing at 283.5 N."""
    (block,) = (b for b in told.price_blocks(fixture.build_optimisation()) if isinstance(b, Notes))
    lines = block.items
    assert lines == [
        "Relaxing stiffness_min by 10 % (to 9 kN/mm) saves 14.8 g (7.2 %), the most of any"
        " requirement.",
        "Among the design's fixed values, 10 % less supply.pressure (to 189 bar) saves 7.90 g"
        " (3.8 %).",
        "The search found no feasible design with friction_running at 283.5 N.",
    ]
    told_in_json = fixture.build_optimisation().to_dict()["what_buys_most"]["sentence"]
    assert text.pretty(told_in_json) == " ".join(lines)


def test_tornado_names_lost_ends_and_nothing_overlaps():
    """Every row that changes anything has its name, and the lost end says so."""
    boxes = tornado(fixture.build_optimisation()).text_boxes()
    words = [box[0] for box in boxes]
    assert words.count("no design") == 1
    assert sum(word.startswith(("stiffness_min", "supply.pressure")) for word in words) == 2
    assert not any(word.startswith("natural_frequency") for word in words)
    assert overlaps(boxes) == []


def test_kinked_prices_stand_side_by_side():
    """Where raising and lowering cost differently, both are told, a lost side as infinite."""
    best = fixture.build_optimisation()
    row = replace(best.sensitivities[0], price_up=None, price_down=1e-8)
    told_row = told.sensitivities(replace(best, sensitivities=(row,))).rows[0]
    assert "".join(told_row[5]) == "∞ up, +10.0 down"


def test_margin_of_a_limit_of_zero_is_a_length_not_a_share():
    """3 mm beyond a limit of 0 is 3 mm, not 0.3 %."""
    quantity = text.metric("bore_growth")
    assert text.margin_of(quantity, 0.0, -3e-3) == "−3000 µm"
    assert text.margin_of(quantity, 1e-3, -3e-3, met=False) == "−0.3 %"


def test_a_price_table_takes_few_calls_of_the_model(monkeypatch):
    """Ends are re-solved together: 44 of the steel knee take fewer calls than there are of them."""
    actuator = build(ao.read(DESIGNS / "steel_baseline.yaml").subject())
    solution = solve(actuator.problem, samples=2048)
    calls = []
    compute = actuator_module.compute

    def counted(*given):
        calls.append(1)
        return compute(*given)

    monkeypatch.setattr(actuator_module, "compute", counted)
    rows = sensitivities(actuator, solution)
    assert 2 * len(rows) == 44
    assert len(calls) < 44


@pytest.mark.long
def test_a_limit_of_zero_has_the_price_of_its_equal():
    """Stiffness divided by 10 kN/mm, less 1, at least 0: the price of stiffness by 10 kN/mm."""

    @ao.metric("room", dimension="ratio")
    def room(values):
        return values.metric("stiffness_min") / 10e6 - 1

    design = ao.read(DESIGNS / "steel_baseline.yaml").design
    others = {k: v for k, v in design.requirements.items() if k != "stiffness_min"}
    assert design.requirements["stiffness_min"].min == 10e6
    other = design.model_copy(update={"requirements": others | {"room": Limit(min=0.0)}})
    known = {}
    for name, subject in {
        "stiffness_min": prepare(design),
        "room": prepare(other, plugins=collect(room)),
    }.items():
        actuator = build(subject)
        rows = sensitivities(actuator, solve(actuator.problem, samples=256, starts=1))
        known[name] = next(x for x in rows if x.parameter == f"requirements.{name}.min")
    equal = known["stiffness_min"]
    assert known["room"].active
    assert known["room"].limit == 0
    assert known["room"].price == pytest.approx(10e6 * equal.price, rel=1e-6)
    assert equal.price > 0


def test_prices_between_tie_rods_take_few_calls(monkeypatch):
    """Between tie rods at equal growth: nearly all ends are solved together."""
    calls = {"models": 0, "single": 0}
    compute, search_near = actuator_module.compute, ladder.search_near

    def counted(*given):
        calls["models"] += 1
        return compute(*given)

    def searched(*given, **options):
        calls["single"] += 1
        return search_near(*given, **options)

    monkeypatch.setattr(actuator_module, "compute", counted)
    monkeypatch.setattr(ladder, "search_near", searched)
    best = ao.optimise(DESIGNS / "aerospace.yaml")
    assert calls["models"] < 10
    assert calls["single"] < len(best.sensitivities)
