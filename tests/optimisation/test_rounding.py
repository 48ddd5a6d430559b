"""Whole plies and allowed angles: what may be chosen, the search against enumeration, the cost."""

from __future__ import annotations

import itertools
import json
import math
from dataclasses import replace

import numpy as np
import pytest
import report_fixture as fixture
from cli_runner import bench, run
from hypothesis import given, settings, strategies as st

import actuator_opt as ao
from actuator_opt.base.errors import InputError
from actuator_opt.design import read_design
from actuator_opt.design.model import Ply
from actuator_opt.optimisation.actuator import build
from actuator_opt.optimisation.branch_and_bound import Listed, search
from actuator_opt.optimisation.problem import BoxProblem, PointValues
from actuator_opt.optimisation.rounding import Wanted, misfits, plies, rounded, sizes_of
from actuator_opt.optimisation.solver import solve
from actuator_opt.pages.prices import quality
from actuator_opt.rendering import text

PLIES = Wanted(whole_plies=True)
MATERIALS = ao.read(bench()).subject().materials
HOOP = "      angle: 88 deg\n      thickness: 1.2 mm\n"
AXIAL = "      angle: 25 deg\n      thickness: 1.6 mm\n"
WALL = "  retention.wall:\n    lower: 1 mm\n    upper: 10 mm\n"
PLY = "      ply_thickness: 0.2 mm\n"
BORE = "  cylinder.bore:\n    lower: 20 mm\n    upper: 30 mm\n"
FREE_HOOP = "  barrel.layup[1].thickness:\n    lower: 0.5 mm\n    upper: 4 mm\n"
FREE_AXIAL = "  barrel.layup[2].thickness:\n    lower: 0.3 mm\n    upper: 3 mm\n"
FREE_ANGLE = "  barrel.layup[2].angle:\n    lower: 15 deg\n    upper: 60 deg\n"
WAIVED = "waivers:\n  bond_thermal_factor: the bench stays at one temperature\n"
ANGLES = "  allowed_angles:\n    - 20 deg\n    - 45 deg\n    - 54.7 deg\n    - 88 deg\nrod:\n"


def two_layers(*changes):
    """The bench design with two layers of 0.2 mm plies whose thicknesses are free."""
    return bench(
        ("waivers:\n", WAIVED),
        (HOOP, HOOP + PLY),
        (AXIAL, AXIAL + PLY),
        (FREE_HOOP, FREE_HOOP + FREE_AXIAL),
        *changes,
    )


def with_angle(*changes):
    """The same with a free angle of the outer layer and three allowed angles."""
    return two_layers((FREE_AXIAL, FREE_AXIAL + FREE_ANGLE), ("rod:\n", ANGLES), *changes)


def optimum(text, **options):
    """Continuous optimum and rounding of a design text."""
    return ao.optimise(ao.read(text), starts=2, prices=False, whole_plies=True, **options)


def alone(index, values):
    """A single variable that takes some values."""
    return Listed((index,), np.array(values, dtype=float)[:, None])


def quadratic(weights, middle, coupling, total):
    """Convex: weighted squares about `middle`, and the squared sum's distance from `total`."""
    weights, middle = np.array(weights)[:, None], np.array(middle)[:, None]

    def evaluate(x):
        spread = x.sum(axis=0) - total
        return PointValues((weights * (x - middle) ** 2).sum(axis=0) + coupling * spread**2)

    n = len(weights)
    return BoxProblem(tuple("abcdef"[:n]), np.full(n, 0.5), np.full(n, 8.5), evaluate)


def enumerated(weights, middle, coupling, total, lists):
    """Least value over every choice of the first variables, the last one in closed form."""
    best = np.inf
    for chosen in itertools.product(*lists):
        # stationary in the last variable: w (y - m) + c (y + sum - total) = 0
        y = (weights[-1] * middle[-1] + coupling * (total - sum(chosen))) / (weights[-1] + coupling)
        x = np.array([*chosen, min(max(y, 0.5), 8.5)])
        value = float(weights @ (x - middle) ** 2 + coupling * (x.sum() - total) ** 2)
        best = min(best, value)
    return best


sizes = st.floats(0.2, 3.0)
places = st.floats(1.0, 8.0)


@settings(max_examples=25)
@given(
    weights=st.tuples(sizes, sizes, sizes),
    middle=st.tuples(places, places, places),
    coupling=st.floats(0.0, 3.0),
    total=st.floats(4.0, 20.0),
    first=st.lists(st.integers(1, 8), min_size=1, max_size=5, unique=True),
)
def test_convex_problems_against_enumeration(weights, middle, coupling, total, first):
    """Two listed variables and a continuous one: the least of every combination is found."""
    lists = [sorted(map(float, first)), [1.0, 2.5, 3.0, 6.0, 7.5]]
    problem = quadratic(weights, middle, coupling, total)
    start = solve(problem, starts=2, samples=64)
    listed = [alone(k, values) for k, values in enumerate(lists)]
    found = search(problem, listed, start.x)
    wanted = enumerated(np.array(weights), np.array(middle), coupling, total, lists)
    assert found.objective == pytest.approx(wanted, rel=1e-7, abs=1e-9)
    assert found.objective >= start.objective - 1e-9
    assert found.complete
    assert all(found.x[k] in values for k, values in enumerate(lists))
    bottom = [max((v for v in values if v <= x + 1e-6), default=values[0])
              for values, x in zip(lists, start.x, strict=False)]  # fmt: skip
    assert tuple(map(list.index, lists, bottom)) in found.tried  # rounded down is always tried


def test_every_variable_may_be_listed():
    """With nothing left continuous the search is pure choice: the least of all combinations."""
    weights, middle = np.array([1.0, 2.0, 1.5]), np.array([2.6, 3.4, 5.5])
    problem = quadratic(weights, middle, 1.3, 14.0)
    grid = np.arange(1.0, 9.0)
    found = search(problem, [alone(k, grid) for k in range(3)], solve(problem, samples=64).x)
    points = np.array(list(itertools.product(grid, repeat=3)))
    values = (points - middle) ** 2 @ weights + 1.3 * (points.sum(axis=1) - 14.0) ** 2
    assert found.objective == pytest.approx(values.min(), rel=1e-12)
    np.testing.assert_array_equal(found.x, points[values.argmin()])


@settings(max_examples=25)
@given(
    middle=st.tuples(places, places, places),
    pairs=st.lists(
        st.tuples(st.integers(1, 8), st.integers(1, 8)), min_size=1, max_size=12, unique=True
    ),
)
def test_pairs_against_enumeration(middle, pairs):
    """Two variables of a catalogue of pairs, a third alone: no other combination is taken."""
    weights, counts = np.array([1.0, 1.7, 0.8, 1.2]), [1.0, 3.0, 6.0]
    middle = np.array([*middle, 4.3])
    problem = quadratic(weights, middle, 0.6, 14.0)
    listed = [Listed((0, 2), np.array(sorted(pairs), dtype=float)), alone(1, counts)]
    found = search(problem, listed, solve(problem, starts=2, samples=64).x)
    wanted = min(
        enumerated(weights, middle, 0.6, 14.0, [[float(p)], [c], [float(q)]])
        for p, q in pairs
        for c in counts
    )
    assert found.objective == pytest.approx(wanted, rel=1e-7)
    assert (found.x[0], found.x[2]) in pairs
    assert found.complete


def held(problem, least):
    """The same problem with a sum of at least `least` asked for."""

    def evaluate(x):
        return PointValues(problem.evaluate(x).objective, (x.sum(axis=0) / least - 1)[None])

    return replace(problem, evaluate=evaluate, constraint_names=("sum",))


def test_nothing_fits():
    """No choice meets the constraint: nothing is found, and the search says it looked at all."""
    problem = held(quadratic([1.0, 1.0], [2.0, 2.0], 0.0, 0.0), 9.5)
    start = solve(problem, samples=64)
    assert start.feasible
    found = search(problem, [alone(0, [0.5, 0.8]), alone(1, [3.0])], start.x)
    assert (found.x, found.objective, found.complete) == (None, None, True)
    assert set(found.tried.values()) == {np.inf}


def test_limits_are_told():
    """A search cut short keeps its best and says that it did not end by itself."""
    rng = np.random.default_rng(3)
    problem = quadratic(rng.uniform(0.5, 2, 4), rng.uniform(2, 7, 4), 2.0, 19.3)
    grid = [alone(k, np.arange(1.0, 9.0)) for k in range(4)]
    x = solve(problem, samples=64).x
    short, full = search(problem, grid, x, most=1), search(problem, grid, x)
    assert full.complete
    assert not short.complete
    assert short.objective >= full.objective


@given(
    one=st.floats(0.05e-3, 0.5e-3),
    lower=st.floats(0.1e-3, 1e-3),
    room=st.floats(0.0, 3e-3),
    balanced=st.booleans(),
    angle=st.sampled_from([0.0, 20.0, 45.0, 88.0, 90.0]),
)
def test_choices_are_the_whole_plies_within_bounds(one, lower, room, balanced, angle):
    """Every choice is a whole number of plies (pairs off axis) within the bounds, and all are."""
    design = read_design(two_layers()).design
    ply = design.barrel.layup[1].model_copy(
        update={"ply_thickness": one, "angle": math.radians(angle), "balanced": balanced}
    )
    wall = (design.barrel.layup[0], ply, design.barrel.layup[2])
    free = {"barrel.layup[1].thickness": design.variables["barrel.layup[1].thickness"].model_copy(
        update={"lower": lower, "upper": lower + room})}  # fmt: skip
    barrel = design.barrel.model_copy(update={"layup": wall})
    changed = design.model_copy(update={"barrel": barrel, "variables": free})
    step = one * (2 if balanced and angle not in (0.0, 90.0) else 1)
    room += 1e-9 * step
    wanted = [k * step for k in range(1, 100) if lower - 1e-9 * step <= k * step <= lower + room]
    if not wanted:
        with pytest.raises(InputError, match="no whole number of"):
            sizes_of(changed, PLIES, MATERIALS)
        return
    (listed,) = sizes_of(changed, PLIES, MATERIALS).listed
    np.testing.assert_allclose(listed.rows[:, 0], wanted, rtol=1e-9)


@pytest.mark.parametrize(
    ("thickness", "angle", "balanced", "count"),
    [
        (1.2e-3, 88, True, 6),
        (1.0e-3, 88, True, None),  # two and a half pairs
        (1.0e-3, 88, False, 5),
        (1.0e-3, 90, True, 5),
        (1.0e-3, 0, True, 5),
        (1.1e-3, 0, True, None),
    ],
)
def test_plies_of_a_layer(thickness, angle, balanced, count):
    """Plies count singly along and around the tube, or where not balanced; in pairs elsewhere."""
    layer = {"material": "m", "thickness": thickness, "angle": math.radians(angle)}
    assert plies(Ply(**layer, balanced=balanced, ply_thickness=0.2e-3)) == count
    assert plies(Ply(**layer, balanced=balanced)) is None


def test_an_angle_that_may_be_straight_frees_single_plies():
    """Odd ply counts are choices only beside 0 or 90 deg, where these are allowed."""
    text = two_layers((FREE_AXIAL, FREE_AXIAL + FREE_ANGLE.replace("15 deg", "0 deg")),
                      ("rod:\n", "  allowed_angles: [0 deg, 30 deg]\nrod:\n"))  # fmt: skip
    sizes = sizes_of(read_design(text).design, PLIES, MATERIALS)
    hoop, axial = sorted(sizes.listed, key=lambda one: len(one.index))
    np.testing.assert_allclose(np.diff(hoop.rows[:, 0]), 0.4e-3)
    degrees, counts = np.degrees(axial.rows[:, 1]), np.round(axial.rows[:, 0] / 0.2e-3)
    if axial.index[0] > axial.index[1]:
        degrees, counts = np.degrees(axial.rows[:, 0]), np.round(axial.rows[:, 1] / 0.2e-3)
    found = set(zip(np.round(degrees), counts, strict=True))
    assert found == {(0, n) for n in range(2, 16)} | {(30, n) for n in range(2, 16, 2)}


@pytest.fixture(scope="module")
def simple():
    """Two layers of whole plies beside a continuous bore and skirt."""
    return optimum(two_layers())


@pytest.mark.long
def test_actuator_against_enumeration():
    """Every pair of ply counts with every bore of a fine scan: the lightest feasible is found.

    Independent of any solver; a second scan refines the bore of the best four.
    """
    text = two_layers(
        (WALL, ""),
        ("length: 22 mm\n  wall: 2 mm", "length: 22 mm\n  wall: 4 mm"),
        ("force: 4 kN", "force: 7 kN"),
        ("    lower: 0.5 mm\n    upper: 4 mm", "    lower: 0.5 mm\n    upper: 2.5 mm"),
    )
    actuator = build(ao.read(text).subject())

    def scan(hoop, axial, bores):
        points = np.stack(np.broadcast_arrays(bores, hoop, axial))
        values = actuator.evaluate(points)
        feasible = values.constraints.min(axis=0) >= -1e-6
        return np.where(feasible, values.objective, np.inf)

    bores = np.linspace(0.02, 0.03, 401)
    masses = {
        pair: scan(0.4e-3 * pair[0], 0.4e-3 * pair[1], bores)
        for pair in itertools.product(range(2, 7), range(1, 8))
    }
    finer = {}
    for pair in sorted(masses, key=lambda pair: masses[pair].min())[:4]:
        k = int(masses[pair].argmin())
        near = np.linspace(bores[max(k - 1, 0)], bores[k], 401)
        finer[pair] = scan(0.4e-3 * pair[0], 0.4e-3 * pair[1], near).min()
    rounding = optimum(text).rounding
    assert rounding.met
    assert rounding.complete
    found = tuple(rounding.plies[f"barrel.layup[{i}]"] // 2 for i in (1, 2))
    assert found == min(finer, key=finer.get)
    assert rounding.objective_after == pytest.approx(finer[found], rel=2e-6)
    for row in rounding.runners_up:
        pair = tuple(round(value / 0.4e-3) for value in row.values.values())
        assert row.objective == pytest.approx(masses[pair].min(), rel=1e-3)


def test_the_laws_of_a_rounding(simple):
    """Cost is the loss of the objective, at least 0; layers are whole; every requirement is met."""
    rounding = simple.rounding
    assert rounding.objective_before == simple.objective_value
    assert rounding.cost == pytest.approx(rounding.objective_after - rounding.objective_before)
    assert rounding.cost >= 0
    assert rounding.percent == pytest.approx(100 * rounding.cost / simple.objective_value)
    for row in rounding.variables:
        assert (row.plies is not None) == row.discrete
        if row.discrete:
            assert row.value == float(f"{row.value:.9g}")  # 26 plies of 0.125 mm are 3.25 mm
            assert row.value / 0.2e-3 == pytest.approx(row.plies, rel=1e-12)
            assert row.plies % 2 == 0
    assert misfits(rounding.design) == ()
    assert rounding.evaluation.met
    assert all(row.margin >= -1e-6 for row in rounding.evaluation.requirements)
    costs = [rounding.cost, *(row.cost for row in rounding.runners_up)]
    assert costs == sorted(costs)
    assert rounding.feasible <= rounding.tried
    assert ao.evaluate(rounding.design).metrics == rounding.evaluation.metrics
    assert "rounding costs" in str(simple)


def test_a_whole_optimum_costs_nothing():
    """Bounds that hold the optimum at whole plies leave nothing to round."""
    whole = two_layers(
        (HOOP, HOOP.replace("1.2", "2.4")),
        (AXIAL, AXIAL.replace("1.6", "2")),
        (FREE_HOOP, FREE_HOOP.replace("0.5 mm", "2.4 mm")),
        (FREE_AXIAL, FREE_AXIAL.replace("0.3 mm", "2 mm")),
    )
    found = optimum(whole)
    assert [row.at_bound for row in found.variables][1:3] == ["lower", "lower"]
    assert found.rounding.cost == 0
    assert found.rounding.objective_after == pytest.approx(found.objective_value, rel=1e-9)
    assert all(row.value == pytest.approx(row.continuous) for row in found.rounding.variables)


def test_allowed_angles_are_kept():
    """The angle of the rounded design is one of the shop's, whole plies beside it."""
    found = optimum(with_angle())
    rows = {row.path: row for row in found.rounding.variables}
    angle = math.degrees(rows["barrel.layup[2].angle"].value)
    assert min(abs(angle - allowed) for allowed in (20, 45, 54.7, 88)) < 1e-9
    assert found.rounding.met
    assert found.rounding.cost >= 0
    assert misfits(found.rounding.design) == ()
    assert set(found.rounding.plies) == {"barrel.layup[1]", "barrel.layup[2]"}


def test_what_is_maximised_gets_smaller():
    """The cost of a maximised metric is what it loses."""
    text = two_layers(
        ("minimise: mass", "maximise: stiffness_min"),
        ("requirements:\n", "requirements:\n  mass:\n    max: 300 g\n"),
    )
    rounding = optimum(text).rounding
    assert rounding.objective_after <= rounding.objective_before
    assert rounding.cost == pytest.approx(rounding.objective_before - rounding.objective_after)


def test_a_better_valley_replaces_the_continuous_optimum():
    """Where whole plies beat the continuous point, that was no optimum: it is found anew."""
    subject = ao.read(two_layers()).subject()
    actuator = build(subject)
    best = solve(actuator.problem, starts=2)
    heavy = best.x * np.array([1.0, 1.3, 1.3, 1.3])
    values = actuator.evaluate(heavy[:, None])
    assert values.constraints.min() >= -1e-6
    poor = replace(best, x=heavy, objective=float(values.objective[0]))
    rounding, solution = rounded(actuator, poor, sizes_of(subject.design, PLIES, MATERIALS))
    assert solution.objective == pytest.approx(best.objective, rel=1e-6)
    assert rounding.cost >= 0
    assert rounding.objective_before == solution.objective


NO_PLY = bench()
ONE_PLY = bench((HOOP, HOOP + PLY))
HALF = two_layers((FREE_AXIAL, ""), (AXIAL + PLY, AXIAL.replace("1.6", "1.7") + PLY))


@pytest.mark.parametrize("words", [["whole_plies"], ["standard_sizes"],
                                   ["whole_plies", "standard_sizes"]])  # fmt: skip
@pytest.mark.parametrize(("text", "said"), [
    (NO_PLY, {"barrel.layup[1].thickness": "ply_thickness", "barrel.layup[2].thickness": "ply_t"}),
    (ONE_PLY, {"barrel.layup[2].thickness": "states no ply_thickness"}),
    (HALF, {"barrel.layup[2].thickness": "not a whole number of pairs of plies of 0.2 mm"}),
])  # fmt: skip
def test_layers_whose_plies_cannot_be_whole_are_refused(text, said, words):
    """However whole plies are asked: by layer, with its line and a remedy; metal has no plies."""
    with pytest.raises(InputError) as refusal:
        ao.optimise(ao.read(text), starts=1, **dict.fromkeys(words, True))
    faults = {fault.path: fault for fault in refusal.value.diagnostics}
    assert set(faults) == set(said)
    for path, fault in faults.items():
        assert said[path] in fault.message
        assert fault.line
        assert fault.remedy


def test_a_bore_of_standard_size_alone_is_no_design_to_build():
    """Sizes of the file leave layers free: the design is not called one to build, and says why."""
    block = BORE + "    sizes: iso_3320\n"
    loose = ao.optimise(ao.read(two_layers((BORE, block))), starts=1, prices=False)
    path = "barrel.layup[1].thickness"
    assert loose.rounding.met
    assert path in misfits(loose.best)
    assert path in loose.rounding.unmade
    assert "which cannot be built yet" in loose.shown
    assert any(path in note for note in loose.rounding.notes)
    fibres = ao.optimise(ao.read(bench((BORE, block))), starts=1, prices=False)
    assert fibres.rounding.unmade == (path, "barrel.layup[2].thickness")
    assert "the design to build" not in fibres.shown
    whole = ao.optimise(ao.read(two_layers((BORE, block))), starts=1, prices=False,
                        whole_plies=True)  # fmt: skip
    assert whole.rounding.unmade == ()
    assert "the design to build" in whole.shown


def asked(text, *words, code=0):
    """`optimise --whole-plies --json` of a text."""
    words = ("--json", "--starts", "2", "--whole-plies", *words)
    result = run("optimise", "-", *words, stdin=text.encode())
    assert result.code == code, (result.out[:2000], result.err)
    return result


def test_json_and_saved_design(tmp_path):
    """The object is that of the rounded design, which is the file saved, and has both of them."""
    file = tmp_path / "whole.yaml"
    data = asked(two_layers(), "--write", file).json
    rounding = data["rounding"]
    assert rounding["met"] is True
    assert rounding["objective"]["rounded"] == data["objective"]["value"]
    assert rounding["objective"]["rounded"] == rounding["evaluation"]["metrics"]["mass"]["value"]
    before = rounding["continuous_evaluation"]["metrics"]["mass"]["value"]
    assert rounding["objective"]["continuous"] == before
    assert data["shown"]["design"] == "rounded"
    assert data["shown"]["sizes"] == "whole plies"
    assert "the design with whole plies" in data["shown"]["sentence"]
    assert rounding["cost"] >= 0
    assert all(row["met"] for row in rounding["evaluation"]["requirements"])
    saved = run("evaluate", file, "--json").json
    assert saved["metrics"]["mass"]["value"] == rounding["objective"]["rounded"]
    assert {key: data[key] for key in ("spec_hash", "metrics", "requirements", "checks")} == {
        key: saved[key] for key in ("spec_hash", "metrics", "requirements", "checks")
    }
    for path, row in data["variables"].items():
        assert row["value"] == rounding["variables"][path]["value"]
        assert row["lower"] <= row["value"] <= row["upper"]
    counts = rounding["plies"]
    for i in (1, 2):
        thickness = rounding["variables"][f"barrel.layup[{i}].thickness"]
        assert thickness["plies"] == counts[f"barrel.layup[{i}]"]
        assert f"thickness: {1e3 * thickness['value']:.9g} mm\n" in file.read_text("utf-8")


@pytest.mark.long
def test_terminal(tmp_path):
    """Asked for: a table with plies and cost. Not asked for: one line that names the option."""
    words = ("--starts", "1", "--out", tmp_path, "-v")
    shown = run("optimise", "-", *words, "--whole-plies", stdin=two_layers().encode())
    assert shown.code == 0
    for word in (
        "Whole plies: mass",
        "rounding costs",
        "plies",
        "not proven",
        "designs were tried",
    ):
        assert word in " ".join(shown.out.split()), word
    assert "--whole-plies" not in shown.err
    plain = run("optimise", "-", *words, stdin=two_layers().encode())
    assert "Whole plies" not in plain.out
    (line,) = [line for line in plain.err.splitlines() if not line.startswith("wrote")]
    assert "layup[1].thickness" in line
    assert "--whole-plies" in line
    silent = run("optimise", "-", "--json", "--starts", "1", stdin=two_layers().encode())
    assert (json.loads(silent.out)["rounding"], silent.err) == (None, "")


@pytest.mark.parametrize(
    ("text", "path", "words"),
    [
        (two_layers((FREE_HOOP + FREE_AXIAL, "")), "variables", "nothing to round"),
        (two_layers((PLY, PLY.replace("0.2", "3"))), "barrel.layup[1].thickness",
         "no whole number of pairs of plies of 3 mm lies between 0.5 mm and 4 mm"),
        (with_angle(("lower: 15 deg\n    upper: 60", "lower: 22 deg\n    upper: 40")),
         "barrel.layup[2].angle", "no allowed angle lies between 22 deg and 40 deg"),
    ],
)  # fmt: skip
def test_what_cannot_be_rounded(text, path, words):
    """Nothing to round, or no choice within the bounds: one line at its place, exit 3."""
    (fault,) = asked(text, code=3).errors
    assert words in fault["message"]
    assert fault["path"].endswith(path)
    assert fault["remedy"]
    if path != "variables":
        assert text.splitlines()[fault["line"] - 1].strip() == f"{path}:"


@pytest.mark.long
def test_plies_too_coarse_for_the_requirements(tmp_path):
    """A window of stiffness that lies between 2 and 3 pairs: exit 1, a remedy, nothing saved."""
    fixed = (("bore: 22 mm", "bore: 20 mm"), (AXIAL, AXIAL.replace("1.6", "2")))

    def stiffness(thickness):
        text = bench((HOOP, HOOP.replace("1.2", thickness)), *fixed)
        return ao.evaluate(ao.read(text)).metrics["stiffness_barrel"].value

    least, most = stiffness("0.9"), stiffness("1.1")
    text = two_layers(
        (FREE_AXIAL, ""),
        (BORE, ""),
        *fixed,
        ("requirements:\n", "requirements:\n  retention_factor: {min: 1}\n"
         f"  stiffness_barrel:\n    min: {least} N/m\n"
         f"    max: {most} N/m\n"),
    )  # fmt: skip
    file = tmp_path / "none.yaml"
    result = asked(text, "--write", file, code=1)
    data = result.json
    assert data["status"] == "optimal"
    rounding = data["rounding"]
    assert (rounding["met"], rounding["evaluation"], rounding["feasible"]) == (False, None, 0)
    assert rounding["tried"] >= 2
    assert "designs with whole plies meets all requirements" in rounding["outcome"]
    assert rounding["remedy"]
    assert not file.exists()
    (fault,) = data["errors"]
    assert f"not written, no design to save: {rounding['outcome']}" in fault["message"]
    assert result.err == ""
    assert data["shown"]["design"] == "continuous"
    assert rounding["outcome"] in data["shown"]["sentence"]
    words = ("optimise", "-", "--whole-plies", "--out", tmp_path, "-v")
    shown = run(*words, stdin=text.encode())
    assert shown.code == 1
    assert "Whole plies: no design found" in shown.out
    head = " ".join(shown.out.split("stiffness_barrel")[0].split())
    assert "designs with whole plies meets all requirements" in head
    assert "which is not the design to build" in head
    assert "requirements met " not in head.split(";")[0].replace("continuous: ", "")


def test_page_one_is_the_design_that_is_built(simple):
    """Badge, tiles, drawing, tables and hash are of the rounded design; the sheet says so."""
    assert simple.best_objective > simple.objective_value
    data = fixture.page_data(simple, source_text="", source_name="x.yaml", command="")
    made = fixture.page_data(
        ao.evaluate(simple.best), source_text="", source_name="x.yaml", command=""
    )
    for part in ("section", "hash"):
        assert data[part] == made[part]
    tables = {block.get("title"): block for block in data["blocks"]}
    alone = {block.get("title"): block for block in made["blocks"]}
    for title in ("Requirements", "Check list", "Parts and mass"):
        assert tables[title]["rows"] == alone[title]["rows"], title
    heads = [one["head"] for one in tables["Design variables"]["columns"]]
    place = heads.index("whole plies")
    for row, variable in zip(
        tables["Design variables"]["rows"], simple.rounding.variables, strict=True
    ):
        quantity = text.input_quantity(variable.quantity)
        assert row[place] == text.number(quantity.to_display(variable.value))
    mass = data["tiles"][0]
    assert mass["value"] == text.number(1e3 * simple.rounding.objective_after)
    assert mass["note"].startswith(f"continuous {text.number(1e3 * simple.objective_value)} g, +")
    assert data["verdict"]["lines"][0].startswith("whole plies: ")
    said = "".join(data["sentence"])
    assert "design with whole plies" in said.replace("\u200b", "")
    assert "the design to build" in said
    assert "before rounding" in quality(simple)


def test_prices_keep_to_the_continuous_optimum():
    """`sensitivity --json` is of the continuous optimum: its rows and objective fit together."""
    text = two_layers((FREE_HOOP, FREE_HOOP + "    sizes: whole_plies\n"))
    found = run("sensitivity", "-", "--json", stdin=text.encode()).json
    whole = asked(text).json
    assert found["objective"]["value"] == pytest.approx(
        whole["rounding"]["objective"]["continuous"], rel=1e-6
    )
    assert found["objective"]["value"] < whole["objective"]["value"]
    most = found["what_buys_most"]
    best = most["requirement"]["gain"], most["sentence"]
    assert f"saves {1e3 * best[0]:#.3g} g" in best[1]


def test_a_search_without_time_says_so():
    """No time left after the continuous optimum: no claim that whole plies cannot be met."""
    rounding = optimum(with_angle(), max_seconds=1e-3).rounding
    assert rounding is None or not rounding.complete
    if rounding is not None:
        assert "stopped at its time limit" in rounding.sentence
