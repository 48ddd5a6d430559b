"""`optimise` and `sensitivity`: the contract's JSON, the saved design, and every way to fail."""

from __future__ import annotations

from pathlib import Path

import pytest
from cli_runner import BENCH, KNEE, bench, evaluated, one_object, refused, run, spawn

from actuator_opt.base.errors import InputError
from actuator_opt.design import read_design, with_values

KEYS = {
    "name", "version", "spec_hash", "metrics", "checks", "requirements", "warnings", "unverified",
    "status", "outcome", "objective", "variables", "kkt", "sensitivities", "certificate",
    "evaluations", "seed", "seconds",
}  # fmt: skip
PRICE = {
    "parameter", "limit", "price", "percent_per_percent", "predicted_10", "resolved_10",
    "predicted_minus10", "resolved_minus10", "holds_until",
}  # fmt: skip


def optimised(text=BENCH, *arguments, code=0):
    """The JSON of `optimise` of a text."""
    result = run("optimise", "-", "--json", "--starts", "2", *arguments, stdin=text.encode())
    assert result.code == code, (result.out[:2000], result.err)
    return result.json


@pytest.fixture(scope="module")
def plain():
    """The optimum of the bench design."""
    return optimised()


def test_json_of_the_contract(plain):
    """Every key the contract names is there, bounds hold, and the quality is stated."""
    data = plain
    assert set(data) >= KEYS
    assert data["status"] == "optimal"
    assert data["kkt"]["residual"] <= 1e-6
    assert set(data["kkt"]) >= {"residual", "active", "rank"}
    assert data["objective"]["metric"] == "mass"
    assert data["objective"]["value"] == data["metrics"]["mass"]["value"]
    assert "infeasibility" not in data
    for row in data["variables"].values():
        assert row["lower"] <= row["value"] <= row["upper"]
        assert set(row) >= {"value", "lower", "upper", "at_bound"}
    assert data["sensitivities"]
    for row in data["sensitivities"]:
        assert set(row) >= PRICE
    assert all(row["met"] for row in data["requirements"])


def test_the_alias_and_the_seed_give_the_same(plain):
    """Optimize is optimise; the same seed gives the same numbers, another the same optimum."""
    first = dict(plain)
    alias = run("optimize", "-", "--json", "--starts", "2", stdin=BENCH.encode()).json
    other = optimised(BENCH, "--seed", "7")
    for data in (first, alias, other):
        del data["seconds"]
    assert first == alias
    assert other["objective"]["value"] == pytest.approx(first["objective"]["value"], rel=1e-6)


def test_the_saved_design_repeats_the_optimum(tmp_path):
    """--write keeps full precision: evaluate repeats every margin, optimise starts at its end."""
    file = tmp_path / "best.yaml"
    data = optimised(BENCH, "--write", file)
    result = run("evaluate", file, "--json")
    assert result.code == 0
    for before, after in zip(data["requirements"], result.json["requirements"], strict=True):
        assert after["margin"] == pytest.approx(before["margin"], rel=1e-9, abs=1e-9)
        assert after["met"]
    assert result.json["metrics"]["mass"]["value"] == data["metrics"]["mass"]["value"]
    assert result.json["spec_hash"] == data["spec_hash"]
    assert run("check", file).code == 0
    again = run("optimise", file, "--json", "--starts", "1").json
    assert again["objective"]["value"] == pytest.approx(data["objective"]["value"], rel=1e-6)


@pytest.mark.parametrize(
    ("objective", "better"),
    [
        pytest.param(
            "maximise: stiffness_min",
            lambda d, b: d["stiffness_min"] >= b["stiffness_min"],
            marks=pytest.mark.long,
        ),
        pytest.param(
            "minimise: friction_running",
            lambda d, b: d["friction_running"] <= b["friction_running"] * (1 + 1e-9),
            marks=pytest.mark.long,
        ),
        (
            "minimise:\n    mass: 1\n    friction_running: 0.5",
            lambda d, b: d["friction_running"] <= b["friction_running"] * (1 + 1e-6),
        ),
        pytest.param(
            "maximise:\n    stiffness_min: 1\n    burst_factor: 0.5",
            lambda d, b: d["stiffness_min"] >= b["stiffness_min"] * (1 - 1e-6),
        ),
    ],
)
def test_objectives(objective, better, plain):
    """Any metric or weighted mix can be aimed at; it gets no worse than at the least mass."""

    def values(data):
        return {name: metric["value"] for name, metric in data["metrics"].items()}

    data = optimised(bench(("minimise: mass", objective)))
    assert better(values(data), values(plain))
    assert data["kkt"]["residual"] <= 1e-6


@pytest.mark.parametrize(
    ("objective", "path"),
    [
        ("minimise: line_velocity", "objective"),
        ("minimise: leakage", "objective"),
        ("minimise:\n    mass: 1\n    line_velocity: 2", "objective"),
        ("minimise:\n    mass: 0", "objective.minimise.mass"),
        ("minimise:\n    mass: -1", "objective.minimise.mass"),
        ("minimise: {}", "objective.minimise"),
        ("minimise: [mass]", "objective.minimise"),
    ],
)
def test_objectives_that_cannot_be(objective, path):
    """A metric this design does not have, and weights that mean nothing, are refused."""
    (fault,) = refused(bench(("minimise: mass", objective)), command="optimise")
    assert fault["path"] == path
    assert fault["remedy"]


def test_a_weight_that_weighs_nothing_is_told():
    """A metric of a weighted objective that no variable enters is named; with none, refused."""
    data = optimised(bench(("minimise: mass", "minimise:\n    mass: 1\n    oil_viscosity: 1")))
    assert "no variable affects oil_viscosity, which is part of the objective" in data["warnings"]
    nothing = "minimise:\n    oil_viscosity: 1\n    piston_speed: 1"
    (fault,) = refused(bench(("minimise: mass", nothing)), command="optimise")
    assert "no variable affects oil_viscosity and piston_speed" in fault["message"]


def test_a_design_is_not_saved_to_standard_output():
    """It carries the results: "-" is refused before the work, and no file of that name is left."""
    (fault,) = refused(BENCH, "--write", "-", command="optimise")
    assert "standard output" in fault["message"]
    assert not Path("-").exists()


def test_no_variables():
    """Nothing may move: said, with what to add."""
    text = BENCH[: BENCH.index("variables:")] + BENCH[BENCH.index("requirements:") :]
    for command in ("optimise", "sensitivity"):
        (fault,) = refused(text, command=command)
        assert fault["path"] == "variables"


STIFF = bench(("min: 6 kN/mm", "min: 600 kN/mm"))


@pytest.fixture(scope="module")
def infeasible(tmp_path_factory):
    """An optimisation that asks for a hundred times the stiffness, and the folder it wrote to."""
    folder = tmp_path_factory.mktemp("infeasible")
    words = ("--json", "--starts", "1", "--report", "--out", folder)
    result = run("optimise", "-", *words, "--write", folder / "best.yaml", stdin=STIFF.encode())
    return result, folder


def test_infeasible(infeasible):
    """Exit 1, what to relax together and alone, which bounds stop it; a report, no saved design."""
    result, folder = infeasible
    data = result.json
    assert result.code == 1
    assert data["status"] == "infeasible"
    card = data["infeasibility"]
    assert {"joint", "sole", "bounds"} <= set(card)
    row = next(row for row in card["joint"] if row["metric"] == "stiffness_min")
    assert row["parameter"] == "requirements.stiffness_min.min"
    assert row["needed"] < row["limit"] == 600e6
    assert {name["path"] for name in data["files"]} == {str(path) for path in folder.iterdir()}
    assert not (folder / "best.yaml").exists()
    (fault,) = data["errors"]
    assert fault["file"] == str(folder / "best.yaml")
    assert fault["message"].startswith("not written")
    assert data["remedy"] in fault["message"]
    assert result.err == ""


def test_the_relaxed_requirement_is_feasible(infeasible):
    """What the card says would do, does: relaxing every joint row to its need is feasible."""
    needs = {}
    for row in infeasible[0].json["infeasibility"]["joint"]:
        assert row["parameter"].startswith("requirements.")
        least, slack = (min, 1 - 1e-4) if row["sense"] == "min" else (max, 1 + 1e-4)
        need = row["needed"] * slack
        needs[row["parameter"]] = least(need, needs.get(row["parameter"], need))
    words = [word for path, need in needs.items() for word in ("--set", f"{path}={need!r}")]
    assert optimised(STIFF, *words)["status"] == "optimal"


def test_the_least_bad_point_may_contradict_itself():
    """A search that found nothing good hands back a design, even if its values contradict."""
    design = read_design(BENCH).design
    thick = {"rod.outer_diameter": 0.0215}  # in a bore of 22 mm: no room for its seal
    with pytest.raises(InputError):
        with_values(design, thick)
    assert with_values(design, thick, contradictions=False).rod.outer_diameter == 0.0215


@pytest.mark.parametrize(
    "name",
    [
        "ld_slsqp",
        pytest.param("LD_MMA", marks=pytest.mark.long),
        pytest.param("LN_COBYLA", marks=pytest.mark.long),
        "AUGLAG+LD_LBFGS",
    ],
)
def test_algorithms(name, plain):
    """Algorithms that suit the problem find the same optimum."""
    value = optimised(BENCH, "--algorithm", name)["objective"]["value"]
    assert value == pytest.approx(plain["objective"]["value"], rel=1e-5)


@pytest.mark.parametrize("name", ["nonsense", "", "LD_LBFGS", "LN_BOBYQA", "GN_DIRECT", "\x07"])
def test_algorithms_that_cannot_be(name):
    """Unknown ones, and those that take no constraints, are usage faults with a way out."""
    result = run("optimise", "-", "--json", "--algorithm", name, stdin=BENCH.encode())
    assert result.code == 2
    (fault,) = result.errors
    assert fault["remedy"]


VARIABLES = {
    "supply.pressure": ("150 bar", "250 bar"),
    "fluid.temperature": ("20 degC", "60 degC"),
    "cylinder.stroke": ("90 mm", "130 mm"),
    "barrel.layup[2].angle": ("15 deg", "60 deg"),
    "piston.clearance": ("5 um", "60 um"),
    "seals.piston.section": ("1 mm", "3 mm"),
    "load_cases[stance].force": ("1 kN", "5 kN"),
    "clevis.pin_diameter": ("5 mm", "20 mm"),
    "rod.extension": ("0 mm", "40 mm"),
}


@pytest.mark.long
def test_any_dimension_may_move():
    """Every kind of number can be a variable, all at once, and stays within its bounds."""
    lines = [
        f"  {path}:\n    lower: {lower}\n    upper: {upper}\n"
        for path, (lower, upper) in VARIABLES.items()
    ]
    data = optimised(bench(("variables:\n", "variables:\n" + "".join(lines))))
    assert set(data["variables"]) >= set(VARIABLES)
    for row in data["variables"].values():
        assert row["lower"] <= row["value"] <= row["upper"]


@pytest.mark.parametrize(
    ("path", "bounds"),
    [
        ("seals.piston.count", "lower: 1\n    upper: 4"),
        ("rod.material", "lower: 1 mm\n    upper: 2 mm"),
        ("requirements.stiffness_min.min", "lower: 1 kN/mm\n    upper: 2 kN/mm"),
        ("materials.t700_epoxy.density", "lower: 1000 kg/m^3\n    upper: 2000 kg/m^3"),
        ("load_cases[0].force", "lower: 1 kN\n    upper: 5 kN"),
        ("barrel.layup[7].angle", "lower: 0 deg\n    upper: 90 deg"),
        ("cylinder.bor", "lower: 20 mm\n    upper: 30 mm"),
        ("barrel.length", "lower: 150 mm\n    upper: 200 mm"),
    ],
)
def test_what_cannot_move(path, bounds):
    """Counts, texts, limits, unset values and what no model reads are refused at their line."""
    text = bench(("variables:\n", f"variables:\n  {path}:\n    {bounds}\n"))
    faults = refused(text, command="check")
    assert [path in fault["path"] for fault in faults] == [True]
    line = BENCH[: BENCH.index("variables:")].count("\n") + 2
    assert line <= faults[0]["line"] <= line + 2
    assert refused(text, command="optimise") == faults


@pytest.mark.long
def test_tiny_and_wide_bounds(plain):
    """Bounds a hair apart, and as wide as the quantity allows, are searched all the same."""
    tight = ("    lower: 20 mm\n    upper: 30 mm", "    lower: 22 mm\n    upper: 22.000001 mm")
    assert optimised(bench(tight))["status"] == "optimal"
    wide = ("    lower: 20 mm\n    upper: 30 mm", "    lower: 2 mm\n    upper: 1 m")
    narrow = plain["objective"]["value"]
    assert optimised(bench(wide))["objective"]["value"] <= narrow * (1 + 1e-6)


def test_two_sided_requirements():
    """Min and max of one metric are two rows; both hold at the optimum."""
    text = bench(("min: 6 kN/mm", "min: 6 kN/mm\n    max: 40 kN/mm"))
    rows = [row for row in evaluated(text)["requirements"] if row["metric"] == "stiffness_min"]
    assert {row["sense"] for row in rows} == {"min", "max"}
    assert optimised(text)["status"] == "optimal"


def test_sensitivity(plain):
    """Prices alone: those of optimise, as JSON or as a table."""
    result = run("sensitivity", "-", "--json", stdin=BENCH.encode())
    assert result.code == 0
    assert result.json["kkt"]["residual"] <= 1e-6
    prices = {row["parameter"]: row["price"] for row in result.json["sensitivities"]}
    wanted = {row["parameter"]: row["price"] for row in plain["sensitivities"]}
    assert prices == pytest.approx(wanted, rel=1e-4, abs=1e-9)
    shown = run("sensitivity", "-", stdin=BENCH.encode())
    assert (shown.code, shown.err) == (0, "")
    assert "KKT" in shown.out


def test_the_knee_end_to_end(tmp_path):
    """The main job: tables on stdout, messages on stderr, PDF and pages written, exit 0."""
    file = tmp_path / "best.yaml"
    result = run("optimise", KNEE, "--verbose", "--out", tmp_path / "reports", "--write", file)
    assert result.code == 0, result.err
    written = [line.removeprefix("wrote ") for line in result.err.splitlines()]
    assert str(file) in written
    assert str(tmp_path / "reports" / "knee_bonded.pdf") in written
    assert (tmp_path / "reports" / "knee_bonded.pdf").read_bytes().startswith(b"%PDF")
    assert {str(path) for path in (tmp_path / "reports").iterdir()} <= set(written)
    for word in ("requirements met", "at lower bound", "KKT residual", "%/%"):
        assert word in result.out
    assert run("evaluate", file, "-q").code == 0


@pytest.mark.long
def test_a_certificate_is_proven_and_repeats():
    """The steel knee is within 1.1 % of the best possible; the same input gives the same proof.

    In a process of its own a solver that prints by itself would end up before the JSON.
    """
    steel = Path(__file__).parents[2] / "designs" / "steel_baseline.yaml"
    words = ("optimise", steel, "--certify", "--json", "--starts", "2")
    first, again = run(*words).json, one_object(spawn(*words).stdout)
    found, value = first["certificate"], first["objective"]["value"]
    assert found == again["certificate"]
    assert 0 < found["gap"] < 0.011
    assert found["lower_bound"] == pytest.approx(value * (1 - found["gap"]))
    assert {"stiffness_min", "friction_running", "buckling_factor"} <= set(found["covers"])
    assert set(found["dropped"]).isdisjoint(found["covers"])
    assert found["boxes"] > 0
