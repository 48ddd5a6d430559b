"""The library in a person's hands: one line for each object, pages in notebooks, values by name."""

from __future__ import annotations

import csv
import inspect
import re
import subprocess
import sys
from dataclasses import replace
from functools import cache
from pathlib import Path

import pytest
from cases.one_line import one_line
from cases.shipped import KNEE
from cli_runner import BENCH, DESIGNS
from rendering.test_html import Balance

import actuator_opt as ao
from actuator_opt.api import results
from actuator_opt.base.arguments import guarded
from actuator_opt.optimisation.price_table import Sensitivity

BONDED = DESIGNS / "knee_bonded.yaml"
SLOW = {
    "Prices", "ParetoFront", "Uncertainty", "SealStudy", "Simulation", "Compared", "Identification",
    "Calibrated", "KeptSweep", "Restored", "Run", "Rerun", "Sensitivities", "Verification",
    "Installation",
}  # fmt: skip
"""Kinds that `tests/cli/test_job.py` or `tests/rendering/test_html.py` makes and checks."""
BENDING = "".join(f"{k / 10:g},{3 * k:g},{k / 50:g}\n" for k in range(60))


@cache
def optimum():
    """The optimum of the bench design."""
    return ao.optimise(BENCH, starts=1, prices=False)


@cache
def evaluation():
    """The bench design as it is."""
    return ao.evaluate(BENCH)


def test_the_repr_of_every_result_is_one_short_line(tmp_path):
    """Every kind of result and every public class; printed, a result is its table."""
    (tmp_path / "bend.csv").write_text(f"t [s],F_L [N],w [mm]\n{BENDING}")
    specimen = ao.Specimen(span=0.3, outer_diameter=0.01)
    session = ao.Session.__new__(ao.Session)  # of an optimum that is known already
    session.optimum = optimum()
    bent = ao.bending(tmp_path / "bend.csv", specimen=specimen)
    objects = [
        evaluation(), optimum(), session, ao.compare(BENCH, BONDED), bent, bent.record, specimen,
        ao.sweep(BENCH, ["retention.wall=3mm,4mm"], workers=1), ao.load_library(),
        ao.read(BENCH), evaluation().design, ao.Diagnostic("x" * 500, "y" * 500),
        ao.read_scenario(DESIGNS / "scenarios" / "knee_step.yaml"), ao.explain("mass"),
        ao.explain("mass").entry, ao.catalogue("metrics"), evaluation().table("metrics"),
        ao.Prediction(0.2, {f"path{k}": 0.1 for k in range(40)}, valid=True),
        ao.BareOptimum(0.2, {f"path{k}": 0.1 for k in range(40)}, (), 0.0, None, ()),
        ao.Price("a.b", 0.1, 0.2, 0.3, (0.05, None), ("x" * 200, None), {"c": 0.1}),
        ao.OptimumCurve("a.b", evaluation()["mass"].quantity, (0.1,), (None,), ({},)),
        ao.simulate(DESIGNS / "scenarios" / "course_valve_ramp.yaml").basis,
    ]  # fmt: skip
    made = {type(one).__name__ for one in objects}
    made |= {type(evaluation()[name]).__name__ for name in ("mass", "rod.material")}
    kinds = {name.partition(":")[2] for name in results.KINDS}
    classes = {name for name in ao.__all__ if isinstance(getattr(ao, name), type)}
    errors = {name for name in classes if issubclass(getattr(ao, name), Exception)}
    assert kinds | classes - errors <= made | SLOW
    for one in objects:
        one_line(one)
        if type(one).__name__ in kinds:
            assert len(str(one).splitlines()) > 3
    assert repr(evaluation()).startswith("<Evaluation 'test bench': mass ")
    assert repr(ao.read(BENCH)) == (
        "<Actuator 'test bench': minimise mass, 3 variables, 8 requirements>"
    )


# In a notebook


@pytest.mark.parametrize("text", [BENCH, KNEE], ids=["bench", "knee"])
def test_a_notebook_shows_the_main_parts(text):
    """Headline, limits, section and masses of the page: balanced, escaped, without a script."""
    name = "<script>alert(1)</script>"
    named = re.sub("^name: .*$", f"name: '{name}'", text, count=1, flags=re.MULTILINE)
    evaluated = ao.evaluate(named)
    shown = replace(optimum(), evaluation=evaluated)._repr_html_()
    assert shown.count("<h2>") == 2
    shown = evaluated._repr_html_()
    assert len(shown.encode()) < 60_000
    seen = Balance()
    seen.feed(shown)
    assert not seen.open
    assert {name, "Requirements", "Parts and mass"} <= set(seen.words)
    tags = [tag for tag, _ in seen.seen]
    assert not {"script", "link", "img"} & set(tags)
    assert sum(attributes.get("class") == "drawing" for _, attributes in seen.seen) == 1


def test_a_notebook_shows_pages_without_a_call_of_ours():
    """The page is there in a process that only evaluates; nothing else of `api` was loaded."""
    code = "import sys, actuator_opt as ao; print(ao.evaluate(sys.stdin.read())._repr_html_())"
    command = [sys.executable, "-c", code]
    told = subprocess.run(command, input=BENCH, capture_output=True, text=True, check=True)
    assert told.stdout.count("<article") == 1


def test_the_fault_of_a_design_states_its_place(tmp_path):
    """The message of the exception: file, line, PATH, and what to do."""
    file = tmp_path / "broken.yaml"
    file.write_text(BENCH.replace("bore: 22 mm", "bore: 22 kg"))
    line = BENCH[: BENCH.index("bore: 22 mm")].count("\n") + 1
    with pytest.raises(ao.InputError) as fault:
        ao.evaluate(file)
    told = str(fault.value).splitlines()[0]
    assert told.startswith(f"{file}:{line}:")
    assert "cylinder.bore: " in told
    assert "; write e.g. " in told or "; use " in told


# Values by name


def test_a_metric_by_its_name():
    """Number in SI, text in the unit of reports, where it governs, and which model gives it."""
    mass, force = evaluation()["mass"], evaluation()["push_force"]
    assert float(mass) == mass.value == pytest.approx(sum(evaluation().mass_parts.values()))
    assert mass.text == f"{1000 * mass.value:.4g} g"
    assert repr(mass) == f"<mass {mass.text}>"
    assert (f"{mass:.3f}", f"{mass}") == (f"{mass.value:.3f}", str(mass))
    assert mass <= mass.value < 1.001 * mass.value > mass >= mass.value
    assert not mass < mass.value
    assert not mass > mass.value
    with pytest.raises(TypeError):
        mass < "0.3"  # noqa: B015
    assert (force.case, force.model) == ("stance", "forces.push_force")
    assert optimum()["mass"].value == optimum().best_objective
    assert [*evaluation()] == [*evaluation().metrics]
    assert "mass" in evaluation()
    missing = next(x for x in evaluation().metrics.values() if x.value is None)
    assert missing.text == f"no value: {missing.why}"
    with pytest.raises(ao.InputError, match=missing.name):
        float(missing)


def test_any_path_by_its_name():
    """Numbers, words, limits, load cases; an optimum gives those of the design to build."""
    bore = evaluation()["cylinder.bore"]
    assert (float(bore), bore.text, bore.why) == (0.022, "22 mm", None)
    assert (bore.case, bore.place, bore.model, bore.reference) == (None, None, "", "")
    limit = evaluation()["requirements.stiffness_min.min"]
    assert float(limit) == evaluation().requirements[0].limit
    assert float(evaluation()["load_cases[0].force"]) == float(
        evaluation()["load_cases[stance].force"]
    )
    word = evaluation()["rod.material"]
    assert (word.value, word.text, repr(word)) == (
        "steel_42crmo4", "steel_42crmo4", "<rod.material steel_42crmo4>",
    )  # fmt: skip
    with pytest.raises(ao.InputError, match=r"rod\.material: is not a number"):
        float(word)
    assert f"{word:>15}" == "  steel_42crmo4"
    assert not evaluation()["sensor.mass"].value
    for variable in optimum().best_variables:
        assert float(optimum()[variable.path]) == variable.value


def test_a_price_states_its_unit(tmp_path):
    """2e-8 kg/Pa = 2e-8 * 1e3 g * 1e5 / bar = 2 g/bar; 0.3 kg per unit of a factor = 300 g."""
    rows = (("supply.pressure", "bar", 1e5, 2e-8), ("requirements.burst_factor.min", "", 1.0, 0.3))
    table = replace(
        optimum(),
        sensitivities=tuple(
            Sensitivity(
                parameter=path, label="", unit=unit, scale=scale, limit=1.0, price=price,
                percent_per_percent=None, predicted_10=0.25, resolved_10=None,
                predicted_minus10=None, resolved_minus10=None, holds_until=None, next_active=None,
                active=True, price_up=price, price_down=None,
            )
            for path, unit, scale, price in rows
        ),
    ).table("prices")  # fmt: skip
    assert [*table["price"]] == [2e-8, 0.3]
    assert [*table["price_unit"]] == ["kg/Pa", "kg"]
    text = table.to_csv(tmp_path / "prices.csv").read_text()
    shown = list(csv.DictReader(text.splitlines()))
    for key in ("price", "price_up"):
        assert [float(row[key]) for row in shown] == pytest.approx([2, 300], rel=1e-12)
    assert [row["price_unit"] for row in shown] == ["g/bar", "g"]
    assert float(shown[0]["predicted_10 [g]"]) == 250
    assert "g/bar" in str(table)


@pytest.mark.parametrize(
    ("name", "told"),
    [
        ("mas", 'no metric or PATH "mas"; did you mean "mass"?'),
        ("cylinder.bor", 'no metric or PATH "cylinder.bor"; did you mean "cylinder.bore"?'),
        ("requirements.mas.min", 'no metric or PATH "requirements.mas.min"; did you mean "mass"?'),
    ],
)
def test_an_unknown_name_is_a_key_error_with_advice(name, told):
    """It is both a KeyError and an error of the library, and one line."""
    assert name not in evaluation()
    for result in (evaluation(), optimum()):
        with pytest.raises(KeyError) as fault:
            result[name]
        assert isinstance(fault.value, ao.InputError)
        assert str(fault.value) == told


@pytest.mark.parametrize("name", [None, 3, "", "a\nb", "x" * 10_000, "[", object()])
def test_hostile_names(name):
    """Whatever stands in the brackets: one line."""
    with pytest.raises(KeyError) as fault:
        evaluation()[name]
    assert len(str(fault.value).splitlines()) == 1
    assert len(str(fault.value)) < 600


# Wrong arguments

HOSTILE = (
    None,
    3,
    -1.5,
    float("nan"),
    "",
    b"x",
    [],
    {},
    object(),
    [None],
    {"a": None},
    "\0",
    Path("/"),
)
FUNCTIONS = [
    name for name in ao.__all__
    if inspect.isfunction(getattr(ao, name)) and name not in ("constraint", "metric")
]  # fmt: skip


@pytest.mark.parametrize("name", FUNCTIONS)
def test_wrong_arguments_are_one_family_of_errors(name, tmp_path, monkeypatch):
    """Every public function, whatever stands where it needs something: one line and a remedy."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("ACTUATOR_OPT_RUNS", str(tmp_path / "runs"))
    function = getattr(ao, name)
    parameters = inspect.signature(function).parameters.values()
    kinds = (inspect.Parameter.POSITIONAL_OR_KEYWORD, inspect.Parameter.KEYWORD_ONLY)
    needed = [x.name for x in parameters if x.default is x.empty and x.kind in kinds]
    for value in HOSTILE if needed else ():
        fault = fault_of(lambda value=value: function(**dict.fromkeys(needed, value)))
        assert fault is None or (fault.diagnostics[0].remedy and len(str(fault)) < 1000), fault


def fault_of(call):
    """The library's error in a call; None without one. Any other exception passes."""
    try:
        call()
    except ao.ActuatorError as error:
        return error
    return None


@pytest.mark.parametrize(
    ("call", "told"),
    [
        (
            lambda: ao.evaluate(3),
            "evaluate: design is 3; give Actuator or Design or Evaluation or O",
        ),
        (lambda: ao.optimise(BENCH, seed=-1), "optimise: seed is -1; give 0 to 4294967295"),
        (lambda: ao.optimise(BENCH, seed=2**32), "optimise: seed is 4294967296; give 0 to 42"),
        (lambda: ao.optimise(BENCH, starts=10**400), "optimise: starts is a whole number of 1329"),
        (lambda: ao.optimise(BENCH, starts="many"), 'optimise: starts is "many"; give a whole n'),
        (lambda: ao.seal(BENCH, place="rodd"), "seal: place is \"rodd\"; give 'piston' or 'rod'"),
        (lambda: ao.pareto(BENCH, [3]), "pareto: objectives[0] is 3; give a text"),
        (lambda: ao.save(evaluation(), None), "save: path is None; give a text or a path"),
        (lambda: ao.exit_code(1.0), "float is not a result"),
        (
            lambda: ao.optimise(BENCH, algorithm="slsqpp"),
            'algorithm: there is no algorithm "SLSQPP"; did you mean',
        ),
        (lambda: ao.optimise(BENCH, starts="6"), 'optimise: starts is "6"; give a whole number'),
        (lambda: ao.read(""), "the path is empty; name a design file"),
        (
            lambda: ao.read("cylinder: {bore: 20 mm}"),
            "cylinder: {bore: 20 mm}: no such file; name a file; a text needs at least two lines",
        ),
        (lambda: ao.read(ao.read(BENCH), set={}), "read: source is Actuator, which needs no read"),
        (lambda: ao.read(evaluation()), "read: source is Evaluation, which needs no reading; for"),
        (lambda: ao.optimise(BENCH, set={}), "optimise: takes no set; read the design with set"),
        (lambda: ao.read(BENCH).changed(None), "changes: must be a mapping from PATH to number"),
        (lambda: ao.read(BENCH).changed(["x"]), "changes: must be a mapping from PATH to number"),
        (lambda: ao.read(BENCH).changed({"cylinder.bore": True}), "cylinder.bore: must be a num"),
    ],
)
def test_a_wrong_argument_is_named(call, told):
    """Function, argument, item, and what it must be."""
    with pytest.raises(ao.ActuatorError) as fault:
        call()
    assert str(fault.value).startswith(told)
    assert fault.value.__cause__ is None


def test_a_result_stands_for_its_design():
    """An optimum for its design to build, an evaluation for the design evaluated."""
    best = float(optimum()["cylinder.bore"])
    assert float(ao.evaluate(optimum())["mass"]) == pytest.approx(optimum().best_objective)
    many = ao.evaluate_many(optimum(), {"cylinder.bore": [best]}, metrics=["mass"], workers=1)
    assert many["mass"] == pytest.approx([optimum().best_objective], rel=1e-9)
    assert not ao.check(evaluation())
    again = ao.evaluate(ao.evaluate(evaluation().design))
    assert float(again["mass"]) == float(evaluation()["mass"])
    assert ao.explain("cylinder.bore", evaluation()).value.startswith("22 mm; ")


def test_a_fault_of_the_program_stays_one():
    """With arguments that fit, an exception is not taken for a wrong argument."""

    @guarded
    def broken(number: float) -> float:
        raise ZeroDivisionError(number)

    with pytest.raises(ZeroDivisionError):
        broken(1)
    with pytest.raises(TypeError, match="missing 1 required positional argument"):
        broken()


def test_results_are_saved_as_designs(tmp_path):
    """An optimum and an evaluation are design files whose values are the same."""
    for number, result in enumerate((optimum(), evaluation())):
        path = ao.save(result, tmp_path / f"{number}.yaml")
        again = ao.evaluate(path)
        assert float(again["mass"]) == pytest.approx(float(result["mass"]), rel=1e-12)
    assert dir(ao) == sorted(ao.__all__)
