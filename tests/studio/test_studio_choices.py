"""Words as choices: which are offered, what they bring with them, their optima, files, commands."""

from __future__ import annotations

import shlex

import pytest
from cli_runner import DESIGNS, run

import actuator_opt as ao
from actuator_opt.base.errors import InputError, UsageError
from actuator_opt.studio import cycle
from actuator_opt.studio.choices import ChoiceStudio, entries_of, menus
from actuator_opt.studio.model import Studio
from actuator_opt.studio.worker import Dropped

STIFFNESS = "requirements.stiffness_min.min"
KNEE = ao.read(DESIGNS / "knee.yaml")


def never():
    """Nobody stops the job."""
    return False


@pytest.fixture(scope="module")
def studio(tmp_path_factory):
    """The steel knee in a folder of its own, with words to choose."""
    folder = tmp_path_factory.mktemp("choices")
    file = folder / "steel.yaml"
    file.write_text((DESIGNS / "steel_baseline.yaml").read_text("utf-8"), "utf-8")
    return ChoiceStudio(Studio(str(file), out=folder / "reports"))


def test_menus_of_the_knee():
    """Parts, seals, materials and joints have menus; words of models and of the task have none."""
    offered = {menu.path: menu for menu in menus(KNEE)}
    assert {
        "retention.type", "retention.sleeve.material", "barrel.layup[1].material", "rod.material",
        "seals.piston.type", "seals.rod.compound", "seals.piston.back_up", "seals.rod.section",
        "fluid.material", "cylinder.mount", "cylinder.end_stop",
    } <= offered.keys()  # fmt: skip
    assert not {"name", "barrel.criterion", "load_cases[stance].direction"} & offered.keys()
    labels = [menu.label for menu in offered.values()]
    assert len(set(labels)) == len(labels)
    library = ao.load_library()
    for menu in offered.values():
        words = [option.word for option in menu.options]
        assert menu.word in words
        assert len(set(words)) == len(words) > 1
        if menu.path.endswith((".material", ".compound")):
            assert {library.kind(word) for word in words} == {library.kind(menu.word)}
    joints = {option.word: option for option in offered["retention.type"].options}
    assert joints["pins"].reason == "needs retention.count, retention.diameter, retention.edge"
    assert not joints["bond"].reason
    assert joints["bond"].help == "bonded skirts over the barrel"
    sections = offered["seals.piston.section"].options
    assert sum(option.size == 1.78e-3 for option in sections) == 1  # of AS568: 1.778 mm


@pytest.mark.parametrize(
    ("path", "word", "expected"),
    [
        ("rod.material", "ti_6al4v", {"rod.material": "ti_6al4v"}),
        ("rod.material", "steel_42crmo4", {}),
        ("seals.piston.back_up", "none",
         {"seals.piston.back_up": "none", "seals.piston.back_up_material": None,
          "seals.piston.back_up_thickness": None}),
        ("retention.type", "bond",
         {"retention.type": "bond", "retention.thread": None, "retention.sleeve": None,
          "seals.static": None, "retention.material": "epoxy_structural"}),
    ],
)  # fmt: skip
def test_what_a_word_brings_with_it(path, word, expected):
    """Keys without meaning go, a usual entry comes, and the design is whole."""
    assert entries_of(KNEE, path, word) == expected
    assert ao.evaluate(KNEE.changed(expected)).metrics["mass"].value > 0


def test_back_up_rings_get_the_usual_ring():
    """A seal without back-up rings gets material and thickness from the table of glands."""
    bare = ao.read(DESIGNS / "aerospace.yaml")
    entries = entries_of(bare, "seals.rod.back_up", "one")
    assert entries["seals.rod.back_up_material"] == "back_up_ptfe"
    assert entries["seals.rod.back_up_thickness"].endswith(" mm")
    bare.changed(entries)


@pytest.mark.parametrize(
    "wish",
    [
        {"rod.material": "unobtainium"}, {"rod.material": "t700_epoxy"}, {"name": "x"},
        {"rod.material": "../../etc/passwd"}, {"retention.type": "pins"}, {"notes": "<script>"},
        {"barrel.criterion": "tsai_wu"}, {"objective.minimise": "push_force"},
        {"retention.sleeve.material": "none"}, {"rod.material": 1.0}, {"rod.materials": "ti_6al4v"},
        {"materials.x.density": "iron"}, {"waivers.seal_section": "none"}, {"rod.material": ""},
    ],
)  # fmt: skip
def test_only_offered_words_are_taken(studio, wish):
    """Any other word is refused, and nothing of it is kept."""
    kept = dict(studio._studios)
    with pytest.raises((InputError, UsageError)):
        studio.solve(wish, never)
    assert studio._studios == kept


def test_a_word_is_solved_saved_and_repeated(studio):
    """Its optimum is that of the library; the file and the command give the same design."""
    wish = {"rod.material": "ti_6al4v", STIFFNESS: "9.5 kN/mm"}
    shown = studio.solve(wish, never)
    best = ao.optimise(ao.read(studio._file._file, set=wish), prices=False)
    assert shown["changes"] == {STIFFNESS: 9.5e6}
    assert shown["objective"] <= best.objective_value * (1 + 1e-6)
    words = shlex.split(studio.command())
    assert "rod.material=ti_6al4v" in words
    done = run(*words[1:], "--json", "--no-record")
    assert done.json["objective"]["value"] == pytest.approx(shown["objective"], rel=1e-6)
    assert studio.save(wish, "titanium.yaml", None).written
    saved = studio._file._file.with_name("titanium.yaml")
    assert "material: ti_6al4v" in saved.read_text("utf-8")
    evaluation = ao.evaluate(saved)
    assert evaluation.metrics["mass"].value == pytest.approx(shown["mass"], rel=1e-9)
    assert evaluation.met
    rows = studio.prices(wish, [STIFFNESS], never)["prices"]
    assert rows[0]["value"] == pytest.approx(9.5e6)
    assert studio.curve(wish, STIFFNESS, [9.6e6], never)["objectives"][0] > shown["objective"]
    assert studio.solve({}, never)["objective"] == studio._file._opening.objective_value  # undo
    assert studio.command().split()[2:] == [str(studio._file._file)]


def test_another_joint_has_other_dimensions(studio):
    """Keys that it lacks are gone from description, file and command; wishes for them wait."""
    wish = {"retention.type": "bond", "retention.thread.pitch": "1.2 mm", STIFFNESS: "9 kN/mm"}
    described = studio.describe(wish, never)
    numbers = {row["path"] for row in described["numbers"]}
    assert not numbers & {"retention.thread.pitch", "seals.static.section"}
    assert "retention.material" in {menu["path"] for menu in described["menus"]}
    shown = studio.solve(wish, never)
    assert shown["changes"] == {STIFFNESS: 9e6}
    assert studio.save(wish, "bond.yaml", None).written
    evaluation = ao.evaluate(studio._file._file.with_name("bond.yaml"))
    assert evaluation.metrics["mass"].value == pytest.approx(shown["mass"], rel=1e-9)
    assert "--unset seals.static" in studio.command()


def test_the_long_search_is_no_worse(studio):
    """It is made once, on wish, and its result replaces the first only if it is better."""
    wish = {"caps.material": "al_7075_t6"}
    first = studio.solve(wish, never)
    assert not first["searched"]
    with pytest.raises(Dropped):
        studio.solve(wish, lambda: True, search=True)
    after = studio.solve(wish, never, search=True)
    assert after["searched"]
    assert after["objective"] <= first["objective"]
    assert studio.solve(wish, never)["objective"] == after["objective"]


def test_listed_sizes_are_menus(tmp_path):
    """The design opens at the best sizes; another size is solved, and the file repeats it."""
    text = (DESIGNS / "steel_baseline.yaml").read_text("utf-8")
    text = text.replace("  rod.outer_diameter:\n", "  rod.outer_diameter:\n    sizes: iso_3320\n")
    (tmp_path / "sizes.yaml").write_text(text, "utf-8")
    studio = ChoiceStudio.opened(str(tmp_path / "sizes.yaml"))
    described = studio.describe({}, never)
    menu = next(x for x in described["menus"] if x["path"] == "rod.outer_diameter")
    assert menu["group"] == "Sizes"
    assert {option["size"] for option in menu["options"]} >= {12e-3, 14e-3, 16e-3}
    best = ao.optimise(tmp_path / "sizes.yaml", prices=False).best_evaluation
    first = studio.solve({}, never)
    assert first["mass"] == pytest.approx(best.metrics["mass"].value, rel=1e-6)
    shown = studio.solve({"rod.outer_diameter": 14e-3}, never)
    assert shown["mass"] > first["mass"]
    assert "--unset variables.rod.outer_diameter" in studio.command()
    assert studio.save({"rod.outer_diameter": 14e-3}, "wide.yaml", None).written
    evaluation = ao.evaluate(tmp_path / "wide.yaml")
    assert evaluation.metrics["mass"].value == pytest.approx(shown["mass"], rel=1e-9)
    assert evaluation.design.rod.outer_diameter == pytest.approx(14e-3)


@pytest.mark.long
def test_a_word_that_fits_nowhere(studio):
    """The nearest miss is shown, with the card; the next word is solved as usual."""
    wish = {"rod.material": "al_6061_t6", STIFFNESS: "40 kN/mm"}
    shown = studio.solve(wish, never, explain=True)
    assert not shown["feasible"]
    assert "nothing fits" in shown["card"]
    assert "rod.material=al_6061_t6" in shlex.split(studio.command())
    assert studio.solve({"rod.material": "ti_6al4v"}, never)["feasible"]


def test_a_duty_cycle_as_data():
    """Extremes are kept, the state is that of the report, and energies balance."""
    evaluation = ao.evaluate(DESIGNS / "knee_walking.yaml")
    study = evaluation.duty.cycles[1]
    data = cycle.drawn(evaluation, study.name)
    assert len(data["time"]) == len(data["told"]) <= cycle.MOST + len(study.worst)
    force = next(x for x in data["strips"] if x["title"].startswith("Force"))["curves"][0]
    assert max(force["ys"]) == pytest.approx(study.traces["force"].max(), rel=1e-5)
    assert min(force["ys"]) == pytest.approx(study.traces["force"].min(), rel=1e-5)
    reserve = study.worst["reserve"]
    assert data["time"][data["reserve"]["sample"]] == pytest.approx(reserve.time, rel=1e-5)
    assert f"force reserve {round(reserve.value)} N" in data["told"][data["reserve"]["sample"]]
    assert sum(row["value"] for row in data["energies"]) == pytest.approx(0, abs=1e-6 * 700)
    plane = data["planes"][0]
    assert [curve["along"] for curve in plane["curves"]].count(True) == 1
    for panel in (*data["strips"], *data["planes"]):
        assert panel["y"][0] < panel["y"][1]
        assert all(len(curve["xs"]) == len(curve["ys"]) for curve in panel["curves"])
    for name in ("", "walk\n", "<b>"):
        with pytest.raises(UsageError, match="is no duty cycle"):
            cycle.drawn(evaluation, name)
    with pytest.raises(UsageError, match="is no duty cycle"):
        cycle.drawn(ao.evaluate(KNEE), "walk")
