"""Sizes of variables: what a file may ask, which values that gives, the search among them."""

from __future__ import annotations

import itertools
import json
from dataclasses import replace

import cli_runner
import numpy as np
import pytest
import report_fixture as fixture
from cli_runner import PLIES, bench, refused, run
from hypothesis import given, settings, strategies as st
from problems import pressure_vessel

import actuator_opt as ao
from actuator_opt.base.errors import InputError
from actuator_opt.design import choice_list, read_design
from actuator_opt.design.schema import json_schema
from actuator_opt.design.sizes import groups
from actuator_opt.design.standard_sizes import SERIES
from actuator_opt.design.writer import to_yaml
from actuator_opt.optimisation.actuator import build
from actuator_opt.optimisation.branch_and_bound import Listed, search
from actuator_opt.optimisation.problem import BoxProblem, PointValues
from actuator_opt.optimisation.solver import solve
from actuator_opt.pages.optimum import rounding_notes

BORE = "  cylinder.bore:\n    lower: 20 mm\n    upper: 30 mm\n"
THICKNESS = "  barrel.layup[1].thickness:\n    lower: 0.5 mm\n    upper: 4 mm\n"
WALL = "  retention.wall:\n    lower: 1 mm\n    upper: 10 mm\n"
ROD = "  rod.outer_diameter:\n    lower: 10 mm\n    upper: 18 mm\n"
HOLE = "  rod.inner_diameter:\n    lower: 2 mm\n    upper: 12 mm\n"
SQUEEZE = "  seals.rod.squeeze:\n    lower: 5 %\n    upper: 25 %\n"
SECTION = "  seals.rod.section:\n    lower: 1.5 mm\n    upper: 4 mm\n"


WEAK = ("requirements:\n", "requirements:\n  retention_factor: {min: 1}\n")
"""A bond that may hold larger bores."""


def sized(lines, block=BORE, *changes, more=""):
    """The bench design whose bore (or another variable) also states these lines."""
    return bench((BORE, block + "".join(f"    {line}\n" for line in lines) + more), *changes)


FAULTS = [
    (["sizes: []"], "the list is empty", "write e.g. [25 mm]"),
    (["sizes:"], "no value", "write one"),
    (["sizes: [22 mm, 2.2 cm]"], "the same as value 1", "keep one"),
    (["sizes: [22 mm, 50 mm]"], "50 mm: outside the bounds 20 mm to 30 mm", "widen the bounds"),
    (["sizes: [22]"], "unit missing", "22 mm"),
    (["sizes: [2 bar]"], "bar is a pressure", "mm"),
    (["sizes: [[22 mm]]"], "not a list", "write one value"),
    (["sizes: {a: 22 mm}"], "need sizes, not a block", "write [25 mm]"),
    (["sizes: iso_3230"], '"iso_3230" is not a series', 'did you mean "iso_3320"'),
    (["sizes: 22 mm"], '"22 mm" is not a series', "or list them: [25 mm]"),
    (["sizes: whole_plies"], "whole_plies has no sizes for cylinder.bore", "the thickness of"),
    (["sizes: iso_6020_2"], "no ISO 6020-2 size lies between", "widen the bounds"),
    (["sizes: iso_3320", "step: 1 mm"], "sizes and step", "keep one"),
    (["step: 0 mm"], "more than 1000 sizes", "at least"),
    (["step: 1 nm"], "more than 1000 sizes", "at least"),
    (["step: 1"], "unit missing", "1 m"),
    (["step: 35 mm"], "no multiple of 35 mm lies between 20 mm and 30 mm", "35 mm"),
    (["size: iso_3320"], "unknown key", 'did you mean "sizes"'),
]  # fmt: skip


@pytest.mark.parametrize(("lines", "message", "remedy"), FAULTS)
def test_a_faulty_size_is_one_line_at_its_place(lines, message, remedy):
    """Every fault stands at the line of the variable that asks, says what is wrong, what to do."""
    text = sized(lines)
    (fault,) = refused(text)
    assert message in fault["message"]
    assert remedy in fault["remedy"]
    assert text.splitlines()[fault["line"] - 1].strip().startswith(("size", "step"))


def test_where_nothing_fits_the_nearest_sizes_are_named():
    """No ISO bore between 26 and 31 mm: the line names 25 and 32 mm, in check, option and file."""
    narrow = BORE.replace("20 mm", "26 mm").replace("30 mm", "31 mm")
    free = bench((BORE, narrow), ("bore: 22 mm", "bore: 27 mm"), *PLIES)
    asked = free.replace(narrow, narrow + "    sizes: iso_3320\n")
    for found in (
        refused(asked, command="check"),
        refused(free, "--standard-sizes", command="optimise"),
    ):
        (fault,) = found
        assert fault["message"] == "no ISO 3320 size lies between 26 mm and 31 mm"
        assert "include 25 mm or 32 mm" in fault["remedy"]


@pytest.mark.parametrize(
    ("more", "message", "remedy"),
    [
        (SQUEEZE + "    sizes: iso_3601\n" + SECTION, "depend on seals.rod.section", "or fix it"),
        (SECTION.replace("1.5 mm", "2 mm").replace("4 mm", "2.5 mm") + "    start: 2.2 mm\n"
         "    sizes: iso_3601\n", "no ISO 3601 size lies between 2 mm and 2.5 mm",
         "1.78 mm or 2.62 mm"),
        (ROD + "    sizes: iso_6022\n", "pairs of bore and rod", "sizes: iso_6022"),
        (ROD + HOLE + "    sizes: en_10305_1\n", "depend on rod.outer_diameter", "or fix it"),
        ("  barrel.layup[0].thickness:\n    lower: 0.1 mm\n    upper: 1 mm\n"
         "    sizes: whole_plies\n", "has no ply_thickness", "ply_thickness"),
        ("  barrel.layup[2].angle:\n    lower: 20 deg\n    upper: 40 deg\n"
         "    sizes: allowed_angles\n", "no allowed_angles", "allowed_angles"),
    ],
)  # fmt: skip
def test_sizes_that_hang_on_others_say_what_they_need(more, message, remedy):
    """A series that cannot stand here says why and what would let it."""
    (fault,) = refused(sized([], BORE, more=more))
    assert message in fault["message"]
    assert remedy in fault["remedy"]


def test_a_u_cup_has_no_o_ring_gland():
    """ISO 3601 is refused for a seal that is no O-ring, in words that say so."""
    text = bench((WALL, WALL + SQUEEZE + "    sizes: iso_3601\n"))
    head, tail = (
        text[: text.index("  rod:\n    type: o_ring")],
        text[text.index("  rod:\n    type:") :],
    )
    cup = tail.replace("type: o_ring", "type: u_cup", 1)
    assert any("this seal is a u_cup" in fault["message"] for fault in refused(head + cup))


def of(text, **asked):
    """Rows in mm (or per cent) of every group, by PATHs."""
    found, faults = groups(read_design(text).design, **asked)
    assert not faults
    return {g.paths: [tuple(round(1e3 * x, 9) for x in row) for row in g.rows] for g in found}


def test_series_against_their_tables():
    """ISO 3320, a pair catalogue, drawn tube, O-rings and their glands, worked by hand."""
    wide = BORE.replace("20 mm", "20 mm").replace("30 mm", "45 mm")
    text = sized(["sizes: iso_3320"], more=ROD + "    sizes: iso_3320\n")
    assert of(text) == {
        ("cylinder.bore",): [(20,), (25,)],
        ("rod.outer_diameter",): [(10,), (12,), (14,), (16,), (18,)],
    }
    pairs = sized(["sizes: iso_6020_2"], wide, more=ROD + "    sizes: iso_6020_2\n")
    assert of(pairs) == {
        ("cylinder.bore", "rod.outer_diameter"): [(25, 12), (25, 18), (32, 14), (40, 18)]
    }
    tube = sized([], more=ROD + "    sizes: [10 mm, 12 mm]\n" + HOLE + "    sizes: en_10305_1\n")
    (rows,) = of(tube).values()  # 12 mm outside with walls of 5 to 0.5 mm, 10 mm from 4 mm on
    assert {hole for rod, hole in rows if rod == 12} == {
        2, 3, 4, 5, 6, 6.4, 7, 7.6, 8, 8.4, 9, 9.6, 10, 10.4, 11, 1 + 10
    }  # fmt: skip
    assert (10, 2) in rows
    assert (10, 1) not in rows
    ring = sized([], more=SECTION + "    sizes: iso_3601\n" + SQUEEZE + "    sizes: iso_3601\n")
    (found,) = groups(read_design(ring).design)[0]
    assert [section for section, _ in found.rows] == pytest.approx([1.78e-3, 2.62e-3, 3.53e-3])
    # AS568 reciprocating glands: depths 1.397..1.448, 2.235..2.286 and 3.073..3.124 mm
    depths = [1.4225, 2.2605, 3.0985]
    wanted = [1 - d / s for d, s in zip(depths, [1.78, 2.62, 3.53], strict=True)]
    assert [squeeze for _, squeeze in found.rows] == pytest.approx(wanted, abs=1e-12)


def test_what_is_asked_by_option():
    """--standard-sizes: ISO 3320 for bore and rod, whole plies; what the file states goes first."""
    text = sized(["sizes: [21 mm, 23 mm]"], more=ROD).replace(
        "      thickness: 1.2 mm\n", "      thickness: 1.2 mm\n      ply_thickness: 0.2 mm\n"
    )
    assert of(text) == {("cylinder.bore",): [(21,), (23,)]}
    assert list(of(text, plies=True)) == [("cylinder.bore",), ("barrel.layup[1].thickness",)]
    found = of(text, standard=True)
    assert found[("cylinder.bore",)] == [(21,), (23,)]
    assert found[("rod.outer_diameter",)] == [(10,), (12,), (14,), (16,), (18,)]
    with pytest.raises(InputError, match="no variable has standard sizes"):
        ao.optimise(ao.read(bench((BORE + THICKNESS, ""), *PLIES)), standard_sizes=True)


@settings(max_examples=30, deadline=None)
@given(
    values=st.lists(st.floats(20.1e-3, 29.9e-3), min_size=1, max_size=5, unique=True),
    step=st.floats(1e-5, 9e-3),
)
def test_sizes_survive_writing(values, step):
    """A list, a step and a series are written and read back bit for bit, with and without text."""
    loaded = read_design(sized([]))
    kept = [v for i, v in enumerate(values) if all(not choice_list.same(v, w) for w in values[:i])]
    for change in ({"sizes": tuple(kept)}, {"step": step}, {"sizes": "iso_3320"}):
        bore = loaded.design.variables["cylinder.bore"].model_copy(update=change)
        variables = loaded.design.variables | {"cylinder.bore": bore}
        design = loaded.design.model_copy(update={"variables": variables})
        for source in (None, loaded.source):
            assert read_design(to_yaml(design, source)).design == design


def test_sizes_may_be_set_from_outside():
    """A series and a step can be given by --set; the file need not change."""
    for given_, rows in (("sizes=iso_3320", [(20,), (25,)]), ("step=4 mm", [(20,), (24,), (28,)])):
        path, value = f"variables.cylinder.bore.{given_}".split("=")
        actuator = ao.read(sized([])).changed({path: value})
        (found,) = groups(actuator.design)[0]
        assert [(round(1e3 * row[0]),) for row in found.rows] == rows


def test_the_schema_knows_sizes():
    """What the reader takes the schema takes; a series in the wrong place it refuses."""
    jsonschema = pytest.importorskip("jsonschema")
    validator = jsonschema.Draft7Validator(json_schema())

    def tree(*lines):
        return read_design(sized(["step: 1 mm"])).source.document.data | {
            "variables": {"cylinder.bore": {"lower": "20 mm", "upper": "30 mm"} | dict(lines)}
        }

    for good in ([("sizes", "iso_3320")], [("sizes", ["22 mm"])], [("step", "1 mm")], []):
        assert not list(validator.iter_errors(tree(*good))), good
    for bad in (
        [("sizes", "whole_plies")], [("sizes", [])], [("sizes", "iso_3320"), ("step", "1 mm")],
        [("step", "1 bar")],
    ):  # fmt: skip
        assert list(validator.iter_errors(tree(*bad))), bad
    assert all(series.suits and series.label for series in SERIES.values())


def test_pressure_vessel_of_gauges():
    """Shell and head in sixteenths of an inch: 6059.714335 at .8125, .4375 [Sandgren1990]."""
    problem = pressure_vessel().problem
    gauges = 0.0625 * np.arange(1, 100)
    start = solve(problem, starts=4, samples=1024)
    assert start.objective == pytest.approx(5885.332774, rel=1e-9)
    listed = [Listed((k,), gauges[:, None]) for k in range(2)]
    found = search(problem, listed, start.x)
    assert found.complete
    assert found.objective == pytest.approx(6059.714335, rel=1e-9)
    np.testing.assert_allclose(found.x, [0.8125, 0.4375, 42.0984456, 176.6365958], rtol=1e-8)
    # every pair near it in closed form: the gauges give the radius, the volume the length
    rows = np.array(list(itertools.product(gauges[8:20], gauges[4:12])))
    radius = np.minimum(rows[:, 0] / 0.0193, rows[:, 1] / 0.00954)
    length = (1296000 - 4 / 3 * np.pi * radius**3) / (np.pi * radius**2)
    cost = problem.evaluate(np.stack([*rows.T, radius, length])).objective
    assert np.min(cost[(length <= 200) & (length >= 10)]) >= found.objective * (1 - 1e-9)


@pytest.mark.long
def test_gear_train():
    """Four gears of 12 to 60 teeth for a ratio of 1/6.931: 2.7008571e-12 [Sandgren1990].

    Nearly every box has the bound 0: only depth leads to a design, on any scale of the objective.
    """

    def evaluate(x, scale=1.0):
        return PointValues(scale * (1 / 6.931 - x[0] * x[1] / (x[2] * x[3])) ** 2)

    teeth = np.arange(12.0, 61.0)
    listed = [Listed((k,), teeth[:, None]) for k in range(4)]
    problem = BoxProblem(tuple("abcd"), np.full(4, 12.0), np.full(4, 60.0), evaluate)
    start = solve(problem, starts=2, samples=64)
    found = search(problem, listed, start.x, most=1000)
    pairs = np.outer(teeth, teeth)  # of either shaft: every ratio there is
    ratios = np.unique(pairs)[:, None] / np.unique(pairs)
    assert found.objective == pytest.approx(((1 / 6.931 - ratios) ** 2).min(), rel=1e-9)
    assert sorted(found.x[:2]) == [16, 19]
    assert sorted(found.x[2:]) == [43, 49]
    short, large = (
        search(replace(problem, evaluate=lambda x, s=s: evaluate(x, s)), listed, start.x, most=200)
        for s in (1.0, 2.0**20)
    )
    assert short.objective < 1e-9
    assert large.objective == short.objective * 2.0**20


def test_spring_of_listed_wire():
    """Coils counted and wire of a list: 2.658559 at 9 coils of 0.283 in [Sandgren1990]."""
    # the list of wires from 0.2 in on; 1000 lbf, preload 300 lbf, 1.25 in of stroke, 14 in long
    wires = [0.207, 0.225, 0.244, 0.263, 0.283, 0.307, 0.331, 0.362, 0.394, 0.4375, 0.5]

    def evaluate(x):
        coils, mean, wire = x
        index = mean / wire
        stress = 8 * ((4 * index - 1) / (4 * index - 4) + 0.615 / index) * 1000 * mean
        rate = 11.5e6 * wire**4 / (8 * coils * mean**3)
        margins = [
            1 - stress / (np.pi * wire**3 * 189000),
            1 - (1000 / rate + 1.05 * (coils + 2) * wire) / 14,
            1 - mean / 3, index / 3 - 1, 1 - 300 / rate / 6, 700 / rate / 1.25 - 1,
        ]  # fmt: skip
        return PointValues(np.pi**2 / 4 * mean * wire**2 * (coils + 2), np.stack(margins))

    lower, upper = np.array([1, 0.6, 0.2]), np.array([30, 3, 0.5])
    problem = BoxProblem(("coils", "mean", "wire"), lower, upper, evaluate, tuple("abcdef"))
    listed = [Listed((0,), np.arange(1.0, 31)[:, None]), Listed((2,), np.array(wires)[:, None])]
    found = search(problem, listed, solve(problem, samples=512).x)
    assert found.complete
    assert found.objective == pytest.approx(2.6585592, rel=1e-7)
    assert (found.x[0], found.x[2]) == (9, 0.283)


def test_a_design_against_enumeration():
    """Own bores and steps of the hoop layer, the skirt scanned: the lightest feasible is found.

    Independent of any solver: a fine scan of the one variable left, refined once.
    """
    block = THICKNESS + "    step: 0.25 mm\n"
    text = sized(["sizes: [21 mm, 22.5 mm, 24 mm, 26 mm]"], BORE, (THICKNESS, block),
                 ("force: 4 kN", "force: 7 kN"), WEAK,
                 ("length: 22 mm", "length: 26 mm"))  # fmt: skip
    actuator = build(ao.read(text).subject())

    def scan(bore, hoop, walls):
        points = np.stack(np.broadcast_arrays(bore, hoop, walls))
        values = actuator.evaluate(points)
        feasible = values.constraints.min(axis=0) >= -1e-6
        return np.where(feasible, values.objective, np.inf)

    walls = np.geomspace(1e-3, 10e-3, 400)
    best = {}
    for bore, count in itertools.product([21, 22.5, 24, 26], range(2, 17)):
        values = scan(1e-3 * bore, 0.25e-3 * count, walls)
        k = int(values.argmin())
        if np.isfinite(values[k]):
            near = np.linspace(walls[max(k - 1, 0)], walls[k], 200)
            best[bore, count] = scan(1e-3 * bore, 0.25e-3 * count, near).min()
    rounding = ao.optimise(ao.read(text), starts=2, prices=False).rounding
    assert rounding.met
    assert rounding.name == "standard sizes"
    rows = {row.path: row for row in rounding.variables}
    found = rows["cylinder.bore"].value, rows["barrel.layup[1].thickness"].value
    wanted = min(best, key=best.get)
    assert found == pytest.approx((1e-3 * wanted[0], 0.25e-3 * wanted[1]), rel=1e-12)
    assert rounding.objective_after == pytest.approx(best[wanted], rel=1e-5)
    assert rows["cylinder.bore"].sizes == "own list"
    assert rows["retention.wall"].sizes is None


@pytest.mark.long
def test_what_allows_the_smaller_size_where_rounding_costs_much():
    """A bore of 20 or 23 mm for 6.4 kN: a little less force, or more pressure, allows 20 mm.

    With the number as printed the rounding ends there, at the mass that was told.
    """
    text = sized(["sizes: [20 mm, 23 mm]"], BORE, ("force: 4 kN", "force: 6.4 kN"), WEAK)
    result = ao.optimise(ao.read(text), starts=2, prices=False)
    rounding = result.rounding
    assert (rounding.met, result.best.cylinder.bore) == (True, 0.023)
    assert rounding.percent > 10
    paths = [remedy.change["parameter"] for remedy in rounding.remedies]
    assert {"load_cases[stance].force", "supply.pressure"} <= set(paths)
    assert not [path for path in paths if "_factor" in path]
    for remedy in rounding.remedies:
        assert remedy.values == {"cylinder.bore": 0.02}
        assert remedy.objective < rounding.objective_after
        assert abs(remedy.change["change"]) <= 0.25
        values = {remedy.change["parameter"]: remedy.change["needed_text"]}
        again = ao.optimise(ao.read(text).changed(values), starts=2, prices=False).rounding
        assert again.objective_after == pytest.approx(remedy.objective, rel=1e-3)
    pressure = next(r for r in rounding.remedies if r.change["parameter"] == "supply.pressure")
    assert pressure.change["needed"] > 21e6
    assert any(pressure.change["needed_text"] in line for line in rounding_notes(result))
    told = rounding.to_dict()["remedies"]
    assert [one["change"]["parameter"] for one in told] == paths


def test_terminal_json_and_file(tmp_path):
    """The table names the series and the cost, JSON has both, the file saved is the made design."""
    file = tmp_path / "made.yaml"
    words = ("--starts", "1", "--standard-sizes", "--write", file)
    data = run("optimise", "-", "--json", *words, stdin=sized([], BORE, *PLIES).encode()).json
    rounding = data["rounding"]
    assert rounding["sizes"] == "standard sizes"
    bore = rounding["variables"]["cylinder.bore"]
    assert bore["value"] in (0.020, 0.025)
    assert (bore["sizes"], bore["discrete"]) == ("ISO 3320", True)
    assert rounding["cost"] >= 0
    assert read_design(file.read_text("utf-8")).design.cylinder.bore == bore["value"]
    saved = run("evaluate", file, "--json").json
    assert saved["metrics"]["mass"]["value"] == rounding["objective"]["rounded"]
    text = sized([], BORE, *PLIES)
    result = ao.optimise(ao.read(text), starts=1, prices=False, standard_sizes=True)
    assert result.best.cylinder.bore == bore["value"]
    assert result.rounding.objective_after == pytest.approx(rounding["objective"]["rounded"])


@pytest.mark.long
def test_choices_with_sizes_are_those_of_brute_force():
    """The best combination is that with the best design of its sizes, each searched alone."""
    lists = {"barrel.layup[1].material": ["t700_epoxy", "im7_8552"], "seals.rod.count": [1, 2]}
    block = "".join(f"  {p}: [{', '.join(map(str, v))}]\n" for p, v in lists.items())
    text = sized(["sizes: [22 mm, 25 mm]"], BORE, (THICKNESS, THICKNESS + "    step: 0.5 mm\n"))
    text = text.replace("12.2 %", "16 %")
    result = ao.optimise(ao.read(f"{text}choices:\n{block}"), starts=2, prices=False)
    alone = {}
    for values in itertools.product(*lists.values()):
        one = ao.read(text).changed(dict(zip(lists, map(str, values), strict=True)))
        found = ao.optimise(one, starts=2, prices=False).rounding
        alone[values] = found.objective_after
    assert result.rounding.objective_after == pytest.approx(min(alone.values()), rel=1e-6)
    best = result.choices.combinations[0]
    assert best.rounded == pytest.approx(result.rounding.objective_after, rel=1e-6)
    assert best.cost == 0
    for one in result.choices.combinations:
        if one.rounded is not None:
            own = alone[tuple(v if isinstance(v, str) else round(v) for v in one.values.values())]
            assert one.rounded >= own * (1 - 1e-6)
            assert one.cost == pytest.approx(one.rounded - best.rounded, abs=1e-9)
    assert "with sizes" in fixture.shown(result)
    json.dumps(result.to_dict()["choices"])


def test_a_choice_whose_gland_does_not_fit_is_no_combination():
    """The gland of 1.78 mm rings squeezes by 20 %: not possible below 17 %, and it says so."""
    more = SQUEEZE.replace("25 %", "17 %") + "    sizes: iso_3601\n"
    text = sized([], BORE, more=more)
    place = text.index("  rod:\n    type: o_ring")
    text = text[:place] + text[place:].replace("section: 1.78 mm", "section: 2.62 mm", 1)
    text += "choices:\n  seals.rod.section: [1.78 mm, 2.62 mm]\n"
    result = ao.optimise(ao.read(text), starts=1, prices=False)
    thick, thin = result.choices.combinations
    assert thin.values["seals.rod.section"] == pytest.approx(1.78e-3)
    assert "no ISO 3601 size lies between 5 % and 17 %" in thin.status
    assert thick.rounded == pytest.approx(result.rounding.objective_after)
    squeeze = result.best.seals.rod.squeeze
    assert squeeze == pytest.approx(1 - 2.2605 / 2.62, abs=1e-9)


def test_sizes_that_meet_nothing_say_so():
    """Bores too small for the force: the continuous design stands, no design of sizes is found."""
    text = sized(["sizes: [20 mm, 20.1 mm]"], BORE, ("force: 4 kN", "force: 7 kN"))
    result = ao.optimise(ao.read(text), starts=1, prices=False)
    assert result.evaluation.met
    rounding = result.rounding
    assert (rounding.met, rounding.evaluation, result.best) == (False, None, result.design)
    assert "designs with standard sizes meets all requirements" in rounding.sentence
    assert "the nearest design, cylinder.bore 20.1 mm, misses force[stance]" in rounding.sentence
    # 20.1 mm at 210 bar, less 5 bar on the ring: at most 6.55 kN of the 7 kN asked, 6.4 % missed
    missed = float(rounding.sentence.split(" by ")[1].split()[0])
    assert 100 * (7000 - 21e6 * np.pi * 0.0201**2 / 4) / 7000 < missed < 12
    assert "allow more sizes" in rounding.remedy


def test_the_bench_names_its_variables():
    """The texts above change what they mean to: the bench design still has these blocks."""
    for block in (BORE, THICKNESS, WALL):
        assert cli_runner.BENCH.count(block) == 1
