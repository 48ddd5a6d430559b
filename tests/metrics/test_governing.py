"""The governing value of a metric is one: in tables, JSON, sweeps, fronts and the optimiser."""

from __future__ import annotations

import json
import math
import re
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from cli_runner import run
from sweep_case import NEAR

import actuator_opt as ao
from actuator_opt.design.model import Limit, Objective
from actuator_opt.evaluation import compute, evaluate, prepare
from actuator_opt.evaluation.build import evaluate_many
from actuator_opt.evaluation.plugin import collect
from actuator_opt.metrics.table import METRICS, ROWS
from actuator_opt.optimisation import pareto
from actuator_opt.optimisation.actuator import build, goal_of
from actuator_opt.optimisation.pareto import ParetoFront
from actuator_opt.optimisation.rounding import design_at
from actuator_opt.optimisation.stored_results import from_plain, to_plain
from actuator_opt.pages import limits as limit_tables, report as page
from actuator_opt.rendering import paper, terminal, text
from actuator_opt.rendering.blocks import short
from actuator_opt.rendering.console import Console

DESIGNS = ("knee_bonded", "servo_knee", "aerospace", "aalto_40_25_220", "linkage")
LINKAGE = "linkage:\n  base_radius: 202.4 mm\n  crank_radius: 151.8 mm\n\nload:\n"
SENSES = ("min", "max")


@cache
def subject(name):
    """A shipped design, or the knee on a linkage."""
    file = Path("designs") / f"{'knee_bonded' if name == 'linkage' else name}.yaml"
    source = file.read_text(encoding="utf-8")
    if name == "linkage":
        source = source.replace("load:\n", LINKAGE, 1)
    return prepare(ao.read(source).design)


@cache
def everything(name):
    """Every value of every metric that has finite ones, by brute force: loops over plain arrays."""
    one = subject(name)
    computed = compute(one, one.values()).computed
    found = {}
    for metric, places in computed.metrics.items():
        values = []
        for place, array in places.items():
            table = np.asarray(array)
            if table.ndim < 2:
                values += [float(table.ravel()[0])]
                continue
            own = computed.applies_at.get((metric, place), computed.applies.get(metric))
            marks = [True] * len(one.cases) if own is None else np.ravel(own).tolist()
            values += [float(row[0]) for row, mark in zip(table, marks, strict=True) if mark]
        if values and all(map(math.isfinite, values)):
            found[metric] = values
    return found


def between(values):
    """A limit between the extremes of a metric, or beside its only value."""
    middle = (min(values) + max(values)) / 2
    return middle if min(values) < max(values) else 0.99 * middle + 1e-9


def limited(name, limits):
    """The design with other requirements, which start where the design stands."""
    one = subject(name)
    free = {p: v.model_copy(update={"start": None}) for p, v in one.design.variables.items()}
    design = one.design.model_copy(update={"requirements": limits, "variables": free})
    return prepare(design)


def margin(value, limit, sense):
    """The contract's margin."""
    apart = (value - limit) / (abs(limit) or 1.0)
    return apart if sense == "min" else -apart


def table_rows(evaluation):
    """First value of every metric in the terminal's table."""
    table = next(limit_tables.quantities(evaluation))
    shown = terminal.block_text(table, Console(width=400)).replace("(!)", "").splitlines()
    cells = (re.split(" +", line) for line in shown)
    return {row[0]: row[1] for row in cells if len(row) > 2}


@pytest.mark.parametrize("sense", SENSES)
@pytest.mark.parametrize("name", DESIGNS)
def test_a_limited_metric_is_governed_by_its_limit(name, sense):
    """Every metric that a design computes, limited between its extremes: one value everywhere."""
    known = everything(name)
    pick = min if sense == "min" else max
    limits = {metric: Limit(**{sense: between(values)}) for metric, values in known.items()}
    one = limited(name, limits)
    evaluation = evaluate(one)
    as_json = json.loads(json.dumps(evaluation.to_dict()))
    rows = {row["name"]: row for row in as_json["requirements"]}
    shown, printed = table_rows(evaluation), str(evaluation).splitlines()
    data = paper.plain_blocks([limit_tables.requirements(evaluation)])[0]
    names = ((row, row[0] if isinstance(row[0], str) else "".join(row[0]))
             for row in data["rows"])  # fmt: skip
    block = {name.removesuffix(" (!)"): row[3] for row, name in names}  # outside its range or not
    tiles = page.key_figures(evaluation)
    swept = evaluate_many(one, {"supply.pressure": np.full(2, one.numbers["supply.pressure"])}, 2)
    actuator = build(one) if one.design.variables else None
    assert len(known) > 50
    for metric, values in known.items():
        quantity = METRICS[metric]
        worst, limit = pick(values), between(values)
        own = margin(worst, limit, sense)
        assert as_json["metrics"][metric]["value"] == worst, metric
        assert (rows[metric]["value"], rows[metric]["limit"]) == (worst, limit), metric
        assert rows[metric]["margin"] == pytest.approx(own, rel=1e-12, abs=1e-15), metric
        assert rows[metric]["met"] == (own >= -1e-6), metric
        if metric not in ("push_force", "pull_force", "joint_torque_min"):  # the cases' own limits
            assert shown[metric] == text.number(quantity.to_display(worst)), metric
        assert block[metric] == text.value_text(quantity, worst), metric
        said = quantity.text(worst)
        assert any(line.split()[:1] == [metric] and said in line for line in printed), metric
        assert swept.metrics[metric] == pytest.approx([worst] * 2, rel=1e-9), metric
        if actuator is not None:
            own_rows = [r for r in (*actuator.rows, *actuator.fixed) if r.limit_of.name == metric]
            row = min(own_rows, key=lambda r: r.margin[0])
            assert float(row.value[0]) == pytest.approx(worst, rel=1e-9), metric
            assert float(row.margin[0]) == pytest.approx(own, rel=1e-6, abs=1e-9), metric
    labels = {short(ROWS[m].short or METRICS[m].label, 30): m for m in known}
    assert len(tiles) == 5
    for tile in tiles:
        metric = labels[short(tile.label, 30)]
        row = page._limited(evaluation, metric)
        assert tile.value == text.number(METRICS[metric].to_display(row.value))


@pytest.mark.parametrize("name", DESIGNS)
def test_limits_both_ways_keep_their_own_values(name):
    """Two rows with a value each; the metric shows the one with the smaller margin."""
    known = {metric: values for metric, values in everything(name).items() if metric != "mass"}
    limits, chosen = {}, {}
    for k, (metric, values) in enumerate(known.items()):
        low, high = min(values), max(values)
        width = (high - low) or abs(high) or 1.0
        limits[metric] = Limit(
            min=low - (0.1 if k % 2 else 0.2) * width, max=high + (0.2 if k % 2 else 0.1) * width
        )
        below = margin(low, limits[metric].min, "min")
        above = margin(high, limits[metric].max, "max")
        chosen[metric] = low if below <= above else high
    one = limited(name, limits)
    evaluation = evaluate(one)
    rows = {row.name: row.value for row in evaluation.requirements}
    swept = evaluate_many(one, {"supply.pressure": np.full(2, one.numbers["supply.pressure"])}, 2)
    for metric, values in known.items():
        assert rows[f"{metric} (min)"] == min(values), metric
        assert rows[f"{metric} (max)"] == max(values), metric
        assert evaluation.metrics[metric].value == chosen[metric], metric
        assert swept.metrics[metric] == pytest.approx([chosen[metric]] * 2, rel=1e-9), metric
    apart = [m for m, values in known.items() if min(values) < max(values)]
    assert {chosen[m] == min(known[m]) for m in apart} == {True, False}


@pytest.mark.parametrize("name", DESIGNS)
@pytest.mark.parametrize(("aim", "pick"), [("minimise", max), ("maximise", min)])
def test_an_objective_is_its_metric(name, aim, pick):
    """Minimised by its largest, maximised by its smallest value, whatever its limits are."""
    known = everything(name)
    sense = "min" if pick is max else "max"
    limits = {metric: Limit(**{sense: between(values)}) for metric, values in known.items()}
    base = limited(name, limits)
    weights = dict.fromkeys(known, 1.0)
    design = base.design.model_copy(update={"objective": Objective(**{aim: weights})})
    every = prepare(design)
    goal, evaluation = goal_of(every), evaluate(every)
    computed = compute(every, every.values()).computed
    for metric, values in known.items():
        single = replace(goal, weights={metric: 1.0}, scales={metric: 1.0})
        objective = single.shown(float(np.squeeze(single.value(computed, every.cases))))
        assert objective == evaluation.metrics[metric].value == pick(values), metric
        row = next(row for row in evaluation.requirements if row.name == metric)
        assert row.value == (min(values) if sense == "min" else max(values)), metric


def test_the_terminal_prints_the_value_its_margin_is_of(monkeypatch):
    """`power >= 1 kW` printed 1600 W at -40 %: 600 W of the slower load case are."""
    monkeypatch.setenv("COLUMNS", "100")
    found = run("evaluate", "designs/knee_bonded.yaml", "--set", "requirements.power.min=1 kW")
    lines = found.out.splitlines()
    (line,) = [line for line in lines if line.lstrip("✘ ").startswith("output power ")]
    assert "600.0" in line
    assert "1600" not in line
    assert "40.0 %" in line
    assert "stance" in line


def test_an_optimum_shows_its_objective():
    """What is maximised is the smallest value, in JSON, in the file that is written and in rows."""
    free = ("cylinder.bore", "rod.outer_diameter", "piston.length")
    start = ao.read("designs/knee_bonded.yaml", set=NEAR)
    design = start.design.model_copy(
        update={
            "objective": Objective(maximise="end_stop_pressure"),
            "requirements": {
                **start.design.requirements,
                "end_stop_pressure": Limit(max=3e7),
            },
            "variables": {path: start.design.variables[path] for path in free},
        }
    )
    optimum = ao.optimise(design, prices=False, starts=1)
    found = optimum.to_dict()
    shown = found["metrics"]["end_stop_pressure"]
    cases = optimum.evaluation.metrics["end_stop_pressure"].by_case
    (row,) = [row for row in found["requirements"] if row["metric"] == "end_stop_pressure"]
    assert found["objective"]["value"] == pytest.approx(shown["value"], rel=1e-12)
    assert shown["value"] == min(cases.values())
    assert row["value"] > 1.2 * shown["value"]
    assert row["margin"] == pytest.approx(1 - row["value"] / 3e7, rel=1e-9)
    again = ao.evaluate(optimum.design)
    assert again.metrics["end_stop_pressure"].value == shown["value"]


def test_the_knee_of_a_front_shows_what_is_wanted():
    """A metric wanted large stands with its smallest value, in the points and in the evaluation."""
    known = everything("knee_bonded")["end_stop_pressure"]
    wished = pareto.wishes(["mass:min", "end_stop_pressure:max"], METRICS)
    many = pareto._problem(subject("knee_bonded"), wished, None)
    start = many.actuator.problem.start
    _, evaluation = design_at(many.actuator, start)
    assert evaluation.metrics["end_stop_pressure"].value == min(known) < max(known)
    front = ParetoFront(many.subject.design, "", wished, (), None, many.subject.design, evaluation)
    again = from_plain(ParetoFront, json.loads(json.dumps(to_plain(front)))).evaluation
    assert again.metrics["end_stop_pressure"].value == min(known)
    values = many.actuator.trade(np.array([start]).T)
    assert values.objective[1] == pytest.approx(-min(known), rel=1e-12)


def test_unlimited_is_more_than_any_limit():
    """A part that nothing pushes does not meet a largest buckling factor; nor has it a number."""
    limits = {"bearing_factor": Limit(max=8.0)}
    one = limited("knee_bonded", limits)
    computed = compute(one, one.values()).computed.metrics["bearing_factor"]
    assert np.isinf(computed["head"]).any()
    evaluation = evaluate(one)
    (row,) = [row for row in evaluation.requirements if row.metric == "bearing_factor"]
    assert (row.value, row.met) == (None, False)
    assert evaluation.metrics["bearing_factor"].value is None
    assert not evaluate_many(one, {}, 1).feasible.any()
    least = evaluate(limited("knee_bonded", {"bearing_factor": Limit(min=2.0)}))
    assert least.metrics["bearing_factor"].value == least.requirements[0].value
    assert least.requirements[0].met


def test_a_user_reads_the_worst_place_and_limits_by_it():
    """A metric of several places is read at the worst; a constraint is governed by its least."""

    @ao.metric("guide")
    def guide(design):
        return design.metric("bearing_factor")

    @ao.constraint("guide_room")
    def guide_room(design):
        return design.metric("bearing_factor") - 5

    one = prepare(ao.read("designs/knee_bonded.yaml").design, plugins=collect(guide, guide_room))
    places = compute(one, one.values()).computed.metrics["bearing_factor"]
    stance = min(float(array[0, 0]) for array in places.values())
    assert max(float(array[0, 0]) for array in places.values()) > stance
    evaluation = evaluate(one)
    assert evaluation.metrics["guide_room"].value == pytest.approx(stance - 5, rel=1e-12)
    least = one.design.model_copy(update={"requirements": {"guide": Limit(min=5.0)}})
    evaluation = evaluate(prepare(least, plugins=one.plugins))
    assert evaluation.metrics["guide"].value == pytest.approx(stance, rel=1e-12)


def test_a_scattered_objective_is_its_worst_value():
    """What is maximised scatters in its smallest value, although its largest is its worst."""
    one = subject("knee_bonded")
    design = one.design.model_copy(update={"objective": Objective(maximise="end_stop_pressure")})
    found = ao.uncertainty(design, count=20, rows=0)
    known = everything("knee_bonded")["end_stop_pressure"]
    assert found.nominal["end_stop_pressure"] == pytest.approx(min(known), rel=1e-12)
    assert min(known) < max(known)
