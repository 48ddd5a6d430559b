"""The studio on a design: optima, prices, curves, the section, saved files and reports."""

from __future__ import annotations

import re
import shlex
import threading

import numpy as np
import pytest
from cli_runner import DESIGNS, run

import actuator_opt as ao
from actuator_opt.base.errors import InputError, UsageError
from actuator_opt.base.progress import tell
from actuator_opt.studio import model
from actuator_opt.studio.model import Studio
from actuator_opt.studio.worker import Dropped

STIFFNESS = "requirements.stiffness_min.min"


def never():
    """Nobody stops the job."""
    return False


def always():
    """The job is no longer wanted."""
    return True


@pytest.fixture(scope="module")
def studio(tmp_path_factory):
    """The steel knee in a folder of its own."""
    folder = tmp_path_factory.mktemp("studio")
    file = folder / "steel.yaml"
    file.write_text((DESIGNS / "steel_baseline.yaml").read_text("utf-8"), "utf-8")
    return Studio(str(file), out=folder / "reports")


@pytest.fixture
def text(studio):
    """The design's file, put back afterwards."""
    before = studio._file.read_bytes()
    yield before.decode()
    studio._file.write_bytes(before)


def test_what_is_described(studio):
    """Every number once, with a label that tells it from all others that are asked."""
    described = studio.describe()
    rows = described["numbers"]
    asked = [row["label"] + row["sense"] for row in rows if row["asked"]]
    assert len(set(asked)) == len(asked)
    assert {"force, stance", "force, swing"} <= set(asked)
    sizes = {row["path"]: row["size"] for row in rows}
    assert all(size > 0 for size in sizes.values())
    assert sizes[STIFFNESS] == pytest.approx(10)
    assert sizes["load_cases[swing].side_load"] > 1  # a zero has the size of the largest force
    assert [row["path"] for row in rows if row["whole"]] == [
        "retention.count", "seals.piston.count", "seals.rod.count"
    ]  # fmt: skip
    paths = [row["path"] for row in rows]
    assert len(set(paths)) == len(paths)
    assert not set(paths) & set(studio.actuator.design.variables)
    assert described["goal"]["unit"] == "g"
    assert described["file"] == "steel.yaml"


def test_solve_equals_optimise(studio):
    """The page shows the optimum of the library, with all of its parts."""
    wish = {STIFFNESS: "9.5 kN/mm"}
    shown = studio.solve(wish, never)
    best = ao.optimise(ao.read(studio._file, set=wish), prices=False)
    assert shown["feasible"]
    assert shown["changes"] == {STIFFNESS: 9.5e6}
    assert shown["objective"] == pytest.approx(best.objective_value, rel=1e-6)
    assert sum(row["mass"] for row in shown["masses"]) == pytest.approx(shown["mass"], rel=1e-9)
    held = {row["name"] for row in shown["holds"]}
    assert "stiffness" in held
    assert not any(row["missed"] for row in shown["holds"])
    count = sum(2 * points for part in shown["section"]["parts"] for points in part["polygons"])
    assert len(shown["section"]["numbers"]) == count


def test_advice_that_is_not_followed_is_listed(studio):
    """A thick rod leaves a small annulus, whose pressure with a blocked port exceeds the advice."""
    assert studio.solve({}, never)["advice"] == []
    thick = studio.actuator.changed({"rod.outer_diameter": "18 mm"})
    (line,) = model._not_followed(ao.evaluate(thick))
    assert line.endswith(" (≥ 1)")
    assert float(line.split()[-3]) < 1


def test_the_first_answer_is_the_whole_one(studio):
    """Section, masses, dimensions and limits agree; without a design it only says so, at once."""
    for wish in ({STIFFNESS: "9.3 kN/mm"}, {STIFFNESS: 9.3e6, "cylinder.stroke": "111 mm"}):
        first = studio.first(wish, never)
        whole = studio.solve(wish, never)
        assert (first["whole"], whole["whole"]) == (False, True)
        assert first["objective"] == pytest.approx(whole["objective"], rel=1e-9)
        assert first["dimensions"] == pytest.approx(whole["dimensions"])
        assert first["section"]["parts"] == whole["section"]["parts"]
        assert first["section"]["numbers"] == pytest.approx(whole["section"]["numbers"], abs=2e-4)
        assert first["section"]["lengths"] == whole["section"]["lengths"]
        assert [x["part"] for x in first["masses"]] == [x["part"] for x in whole["masses"]]
        assert first["mass"] == pytest.approx(whole["mass"])
        assert {(x["name"], x["limit"], x["where"]) for x in first["holds"]} == {
            (x["name"], x["limit"], x["where"]) for x in whole["holds"]
        }
        assert studio.first(wish, never)["whole"]  # known by now
    none = {STIFFNESS: "10000 kN/mm"}
    assert studio.first(none, never) == {"searching": True, "changes": {STIFFNESS: 1e10}}
    with pytest.raises(Dropped):
        studio.first({STIFFNESS: 9.15e6}, always)


def test_changes_are_checked(studio):
    """Unknown, not finite, out of range, free dimensions, words: each is refused by name."""
    for wish in (
        {"cylinder.strokes": 0.1}, {"cylinder.stroke": "3 bananas"}, {"cylinder.stroke": -1.0},
        {"cylinder.stroke": 1e9}, {"cylinder.bore": 0.02}, {"rod.material": "ti_6al4v"},
        {"variables.cylinder.bore.lower": 0.01}, {"cylinder": 3.0},
    ):  # fmt: skip
        with pytest.raises((InputError, UsageError)) as refused:
            studio.solve(wish, never)
        assert next(iter(wish)).partition(".")[0] in str(refused.value)


def test_the_value_of_the_file_is_no_change(studio):
    """So the page can go back to the file."""
    stroke = studio.actuator.design.cylinder.stroke
    assert studio.solve({"cylinder.stroke": stroke}, never)["changes"] == {}


def test_a_stopped_wish_is_dropped(studio):
    """Solving, prices and curves ask whether they are still wanted."""
    with pytest.raises(Dropped):
        studio.solve({STIFFNESS: 9.1e6}, always)
    with pytest.raises(Dropped):
        studio.prices({}, [STIFFNESS], always)
    with pytest.raises(Dropped):
        studio.curve({}, STIFFNESS, [9.1e6], always)


def test_prices_and_the_forecast_of_the_section(studio):
    """The price is that of a session there; the forecast of the section is off by second order."""
    wish = {STIFFNESS: "9 kN/mm"}
    paths = [STIFFNESS, "cylinder.stroke", "seals.rod.count", "clevis.neck", "retention.count"]
    answer = studio.prices(wish, paths, never, draw=True)["prices"]
    assert [row["path"] for row in answer] == paths[:4]  # the last cannot change alone
    price, _, count, zero = answer
    more = studio.solve({**wish, "seals.rod.count": 2}, never)["objective"]
    assert count["up"] == pytest.approx(more - studio.solve(wish, never)["objective"], rel=1e-4)
    assert (count["value"], zero["value"]) == (1, 0)
    assert zero["up"] > 0
    reference = ao.session(ao.read(studio._file, set=wish)).price(STIFFNESS)
    assert price["up"] == pytest.approx(reference.slope_up, rel=1e-4)
    assert price["high"] > 1.02 * price["value"]
    before = np.array(studio.solve(wish, never)["section"]["numbers"])
    errors, moves = [], []
    for share in (0.02, 0.01):
        step = share * price["value"]
        after = studio.solve({STIFFNESS: price["value"] + step}, never)["section"]["numbers"]
        errors.append(np.abs(before + np.array(price["section"]) * step - after).max())
        moves.append(np.abs(before - after).max())
    assert moves[0] > 0.05
    assert errors[0] < 0.05 * moves[0]
    assert errors[1] < 0.35 * errors[0] + 2e-4


def test_a_curve_has_optima_and_gaps(studio):
    """A value has its optimum, or none where no design is found."""
    answer = studio.curve({}, STIFFNESS, [9.5e6, 1e6 * 1e4], never)
    alone = studio.solve({STIFFNESS: 9.5e6}, never)
    assert answer["objectives"][0] == pytest.approx(alone["objective"], rel=1e-6)
    assert answer["objectives"][1] is None
    assert answer["dimensions"][1] == {}


def test_the_best_of_one_limit_against_another(studio):
    """Friction is least, the mass stays, and less stiffness allows less friction."""
    best = "requirements.friction_running.max"
    described = {row["path"]: row for row in studio.describe()["best"]}
    assert described[best]["label"] == "best running friction"
    assert described[best]["unit"] == "N"
    shown = studio.solve({}, never)
    answer = studio.curve({}, STIFFNESS, [8e6, 8.5e6], never, best=best)
    low, high = answer["objectives"]
    assert low < high <= shown["reached"][best]
    assert shown["objective"] <= answer["budget"] <= shown["objective"] * 1.001
    numbers = {**answer["dimensions"][1], STIFFNESS: 8.5e6}
    there = ao.evaluate(ao.read(studio._file).changed(numbers)).metrics
    assert there["friction_running"].value == pytest.approx(high, rel=1e-6)
    assert there["mass"].value <= answer["budget"] * (1 + 1e-6)
    with pytest.raises(UsageError, match="no limit"):
        studio.curve({}, STIFFNESS, [9e6], never, best="requirements.mass.max")
    with pytest.raises(Dropped):
        studio.curve({STIFFNESS: 9.1e6}, STIFFNESS, [9e6], always, best=best)


def test_a_saved_file_is_the_optimum(studio, text):
    """Comments stay, the changed limit stands there, and `evaluate` agrees to 1e-9."""
    wish = {STIFFNESS: "9.5 kN/mm"}
    shown = studio.solve(wish, never)
    saved = studio.save(wish, "saved.yaml", None)
    file = studio._file.with_name("saved.yaml")
    written = file.read_text("utf-8")
    comments = [line.strip() for line in text.splitlines() if line.strip().startswith("#")]
    assert comments
    assert all(comment in written for comment in comments)
    assert "min: 9.5 kN/mm" in written
    evaluation = ao.evaluate(file)
    assert evaluation.metrics["mass"].value == pytest.approx(shown["mass"], rel=1e-9)
    assert evaluation.met
    again = studio.save(wish, "saved.yaml", None)
    assert (saved.written, again.written, again.sha256) == (True, False, saved.sha256)
    assert studio._file.read_text("utf-8") == text


def test_a_design_that_changed_on_disk_is_never_overwritten(studio, text):
    """It is said, and even its new hash does not help; unchanged, it may be replaced once asked."""
    name = studio._file.name
    asked = studio.save({STIFFNESS: 9.4e6}, name, None)
    assert not asked.written
    studio._file.write_text(f"{text}# by hand\n", "utf-8")
    assert studio.solve({}, never)["changed_on_disk"]
    stands = model.digest(studio._file)
    for replacing in (None, asked.sha256, stands):
        with pytest.raises(InputError, match="changed on disk"):
            studio.save({STIFFNESS: 9.4e6}, name, replacing)
    assert studio._file.read_text("utf-8").endswith("# by hand\n")
    studio._file.unlink()
    assert studio.solve({}, never)["changed_on_disk"]
    studio._file.write_text(text, "utf-8")
    before = studio._digest
    assert studio.save({STIFFNESS: 9.4e6}, name, asked.sha256).written
    assert not studio.changed_on_disk()
    studio._digest = before


def test_the_command_finds_the_same_design(studio):
    """The line that Ctrl-C prints, run by the command line."""
    shown = studio.solve({STIFFNESS: "9.5 kN/mm", "cylinder.stroke": "0.112 m"}, never)
    words = shlex.split(studio.command())
    assert words[:2] == ["actuator-opt", "optimise"]
    done = run(*words[1:], "--json", "--no-record")
    assert done.code == 0
    assert done.json["objective"]["value"] == pytest.approx(shown["objective"], rel=1e-6)


def test_the_report_is_that_of_the_state(studio):
    """It is written under the design's name, and can be run again."""
    files = studio.report({STIFFNESS: "9.5 kN/mm"})
    (page,) = (name for name in files if name.endswith("steel.pdf"))
    again = run("rerun", page, "--no-record")
    assert again.code == 0
    assert "the result is reproduced" in again.err


def test_nothing_fits(studio, monkeypatch):
    """The nearest miss is shown, and neither saved, priced nor reported."""
    wish = {STIFFNESS: "10000 kN/mm"}
    shown = studio.solve(wish, never)
    assert not shown["feasible"]
    assert shown["holds"][0]["missed"]
    with pytest.raises(InputError, match="nothing fits"):
        studio.save(wish, "none.yaml", None)
    with pytest.raises(InputError, match="nothing fits"):
        studio.report(wish)
    assert not studio._file.with_name("none.yaml").exists()

    card = (
        "1  seals.rod.friction_coefficient  0.1 → 0.05\n"
        "2  requirements.friction_running.max  200 N → 240 N\n"
        "no help alone: piston.nut.diameter\nno proof; -v shows\nthe search.\n\ncare: one (-v)"
    )
    assert model._for_a_page(card, studio.actuator.design) == (
        "1  rod seal friction coefficient   0.1 → 0.05\n"
        "2  running friction                   200 N → 240 N\n"
        "no help alone: piston nut diameter\nno proof."
    )

    wished = threading.Event()

    def endless(*given, **how):
        while True:
            wished.set()
            tell("searching", 0.5)

    monkeypatch.setattr(model, "optimise", endless)
    with pytest.raises(Dropped):  # a newer wish ends the search for what would help
        studio.solve(wish, wished.is_set, explain=True)
    monkeypatch.setattr(model, "optimise", lambda *given, **how: studio._opening)
    assert studio.solve(wish, never, explain=True)["feasible"]  # the long search found a design
    monkeypatch.undo()
    studio._last = None
    assert studio.solve({}, never)["feasible"]


@pytest.mark.long
def test_a_design_that_fits_nowhere_opens_at_the_nearest_miss(studio):
    """It says what would help; the first wish that fits is the base of all others."""
    opened = Studio(str(studio._file), set=[(STIFFNESS, "40 kN/mm")])
    shown = opened.solve({}, never, explain=True)
    assert not shown["feasible"]
    assert "nothing fits" in shown["card"]
    assert not re.search(r"-v\b|--|next: |requirements\.|seals\.", shown["card"])
    wish = {STIFFNESS: "9.5 kN/mm"}
    best = studio.solve(wish, never)["objective"]
    assert opened.solve(wish, never)["objective"] == pytest.approx(best, rel=1e-6)
    assert not opened.solve({}, never)["feasible"]
    assert opened.prices(wish, [STIFFNESS], never)["prices"]
