"""Records of sweeps and fronts: complete, small, never in the way, reported and explored again."""

from __future__ import annotations

import json
import os
import re
import shutil
import signal
import sqlite3
import subprocess
import time
from pathlib import Path

import pytest
from cases.digests import digest, digests
from cli_runner import BENCH, command, run, spawn, surroundings

import actuator_opt as ao
from actuator_opt.api import recorded_runs
from actuator_opt.base import runs as run_store
from actuator_opt.optimisation import stored_results
from actuator_opt.optimisation.pareto import ParetoFront
from actuator_opt.sweeps.chunk import Study

SMALL = BENCH.replace("  retention.wall:\n    lower: 1 mm\n    upper: 10 mm\n", "").replace(
    "thickness: 1.2 mm", "thickness: 4 mm"
)
VARY = ["--vary", "cylinder.bore=20..22 mm:5", "--vary", "rod.material=steel_42crmo4,ti_6al4v"]
BOTH = ["--objective", "mass:min", "--objective", "stiffness_min:max"]
OWN = (
    "import actuator_opt as ao\n@ao.metric('slenderness')\n"
    "def own(v):\n    return v['cylinder.stroke'] / v['cylinder.bore']\n"
)


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A runs folder of the test's own."""
    place = tmp_path / "runs"
    monkeypatch.setenv("ACTUATOR_OPT_RUNS", str(place))
    monkeypatch.delenv("ACTUATOR_OPT_NO_RECORD", raising=False)
    return place


@pytest.fixture
def design(tmp_path):
    """A small design file, some of whose neighbours meet everything."""
    path = tmp_path / "small.yaml"
    path.write_text(SMALL)
    return path


def swept(design, *options):
    """One sweep, recorded; its JSON."""
    done = run("sweep", design, *VARY, "--json", *options)
    assert done.code in (0, 1), done.out
    assert done.err == ""
    return done.json


def front(design, *options):
    """One front of five designs, recorded; its JSON."""
    done = run("pareto", design, *BOTH, "-n", 5, "--checks", 0, "--json", *options)
    assert (done.code, done.err) == (0, ""), done.out
    return done.json


def told(*words):
    """The one line of a refusal."""
    result = run(*words, "--json")
    assert result.code in (2, 3), result.out
    assert len(result.errors) == 1
    return result.errors[0]["message"] + "; " + result.errors[0]["remedy"]


def test_a_sweep_is_recorded_without_its_rows(folder, design, tmp_path):
    """Plan, counts, best and where the rows are; input, versions, seed and hash as of optimise."""
    store = tmp_path / "rows.db"
    printed = swept(design, "--store", os.path.relpath(store), "--seed", 3)
    (path,) = folder.iterdir()
    shown = run("runs", "show", "last", "--json").json
    assert (shown["id"], shown["kind"], shown["seed"]) == (path.stem, "sweep", 3)
    assert shown["input"]["text"] == SMALL
    assert shown["spec_hash"] == ao.evaluate(design).spec_hash
    assert shown["versions"]["actuator-opt"] == ao.__version__
    assert shown["result"] == printed
    assert (shown["requested"], shown["feasible"]) == (10, printed["feasible"])
    assert shown["objective"]["value"] == printed["best"][0]["metrics"]["mass"]
    assert shown["asked"]["store"]["path"] == str(store)
    (hashed,) = sqlite3.connect(store).execute("SELECT hash FROM studies").fetchone()
    assert shown["asked"]["store"]["study"] == hashed
    bore, material = shown["plan"]["axes"]
    assert (bore["values"], bore["steps"]) == ([0.02, 0.022], 5)
    assert (material["values"], material["texts"]) == (None, ["steel_42crmo4", "ti_6al4v"])
    text = run("runs", "show", "last", encoding="ascii").out
    for words in ("cylinder.bore: 20 mm to 22 mm, 5 steps", "10, grid", f"every row in {store}"):
        assert words in re.sub(r"\n {11}", "", text) or words in text, words
    assert f"{printed['feasible']} feasible" in run("runs", "list").out
    assert run("runs", "list", "--command", "sweep", "--json").json["runs"][0]["met"] is True


@pytest.mark.parametrize(
    ("vary", "words"),
    [
        ("requirements.burst_factor.min=2..3:2", "2 to 3, 2 steps"),
        ("requirements.stiffness_min.min=1,2 kN/mm", "1 kN/mm, 2 kN/mm"),
        ("materials.al_7075_t6.youngs_modulus=70,72 GPa", "70 GPa, 72 GPa"),
        ("load_cases[0].speed=0.1,0.2 m/s", "0.1 m/s, 0.2 m/s"),
    ],
)
def test_every_number_that_varied_is_shown(folder, design, vary, words):
    """Of the design, of a limit and of a material, in the unit people read."""
    done = run("sweep", design, "--vary", vary, "--json")
    assert done.code in (0, 1), done.out
    shown = run("runs", "show", "last")
    assert (shown.code, shown.err) == (0, "")
    assert words in shown.out


@pytest.mark.long
def test_the_record_of_a_large_sweep_stays_small(folder, design, monkeypatch):
    """Whatever is kept or fails: a few best designs and the commonest reasons."""
    small = swept(design, "--reduce", "best:1")
    most = swept(design, "--reduce", "best:9")
    assert len(most["best"]) > 2
    monkeypatch.setattr(recorded_runs, "BEST", 2)
    swept(design, "--reduce", "best:9")
    kept = run("runs", "show", "last", "--json").json
    assert kept["result"]["best"] == most["best"][:2]
    assert kept["asked"]["keep"] == 9
    assert "only the best 9" in run("runs", "show", "last").out
    assert small["best"][0] == most["best"][0]
    many = ao.sweep(design, [VARY[1]])
    many.failures = {f"reason {k}": 1 + k % 7 for k in range(5000)}
    body = ao.record_sweep(many, actuator=ao.read(design)).body
    assert list(body["result"]["failures"].values()) == [7] * recorded_runs.REASONS
    values = ",".join(f"{20 + k / 1000}" for k in range(500)) + " mm"
    assert run("sweep", design, "--vary", f"cylinder.bore={values}", "--reduce", "best:1").code == 0
    assert len(run("runs", "list").out.splitlines()) == 6
    assert len(run("runs", "show", "last").out) < 3000


@pytest.mark.parametrize(
    "more", [pytest.param([], marks=pytest.mark.long), ["--figure", "scatter"]]
)
def test_a_sweep_is_reported_out_of_its_store(folder, design, tmp_path, more, monkeypatch):
    """Figures and CSV to the byte, the design file gone, nothing computed or written."""
    made, again, store = tmp_path / "made", tmp_path / "again", tmp_path / "rows.db"
    swept(design, "--store", store, "--csv", tmp_path / "rows.csv", *more, "--out", made)
    design.unlink()
    before = digest(store)
    monkeypatch.setattr(Study, "chunk", None)
    result = run("report", "last", "--out", again, "--json")
    assert result.code == 0, result.out
    assert {Path(one["path"]).name for one in result.json["files"]} == set(digests(again))
    found = digests(again)
    assert found.pop("test_bench-sweep.csv") == digest(tmp_path / "rows.csv")
    if more:
        assert found == digests(made)
    else:
        assert list(found) == ["test_bench-sweep-parallel.png", "test_bench-sweep-parallel.svg"]
    assert digest(store) == before


@pytest.mark.parametrize("method", ["grid", "sobol", pytest.param("lhs", marks=pytest.mark.long)])
@pytest.mark.parametrize("texts", [[], ["rod.material=steel_42crmo4,ti_6al4v"]])
def test_values_of_the_best_are_those_of_their_points(design, method, texts):
    """Out of their rows as out of the plan, in the order asked for, to the last digit."""
    steps = ":3" if method == "grid" else ""
    vary = [f"rod.outer_diameter=11.5..11.7 mm{steps}", f"cylinder.bore=20..22 mm{steps}", *texts]
    found = ao.sweep(design, vary, method=method, n=None if steps else 40, reduce=True)
    assert found.best
    for best in found.best:
        assert list(found.values(best).items()) == list(found.study.values(best.number).items())


def test_a_parquet_file_comes_again(folder, design, tmp_path):
    """Where the sweep wrote one: the same bytes, the CSV beside it."""
    pytest.importorskip("pyarrow")
    made = tmp_path / "rows.parquet"
    swept(design, "--store", tmp_path / "rows.db", "--parquet", made)
    assert run("report", "last", "--out", tmp_path / "again", "--quiet").code == 0
    found = digests(tmp_path / "again")
    assert found["test_bench-sweep.parquet"] == digest(made)
    assert "test_bench-sweep.csv" in found
    assert str(made) in run("runs", "show", "last", environment={"COLUMNS": "300"}).out


def test_a_store_that_is_not_what_it_was(folder, design, tmp_path):
    """Moved, replaced, cut short or none: one line each that says where it was; nothing written."""
    swept(design)
    assert "without --store" in told("report", "last")
    assert "without --store" in told("explore", "last")
    store, out = tmp_path / "rows.db", tmp_path / "out"
    swept(design, "--store", store)
    aside = tmp_path / "aside.db"
    shutil.copy(store, aside)
    with sqlite3.connect(store) as base:
        base.execute("DELETE FROM rows WHERE id = 4")
    base.close()
    assert "lacks rows of this sweep" in told("report", "last", "--out", out)
    store.unlink()
    for verb in ("report", "explore"):
        words = told(verb, "last", "--out", out)
        assert "no longer exists" in words
        assert "explore F.db" in words
    ao.sweep(design, ["cylinder.bore=21..22 mm:2"], store=store)
    for verb in ("report", "explore"):
        assert "does not contain this sweep" in told(verb, "last", "--out", out)
    store.unlink()
    store.write_text("no database")
    assert "is not a database" in told("explore", "last", "--out", out)
    store.unlink()
    store.mkdir()
    assert "is a folder" in told("explore", "last", "--out", out)
    store.rmdir()
    aside.rename(store)
    assert run("report", "last", "--out", out, "--quiet").code == 0
    assert "not allowed with a run" in told("report", "last", "--set", "load.mass=3 kg")


@pytest.mark.long
def test_explore_takes_a_run(folder, design, tmp_path):
    """The page is that of the store's study, whichever is its newest; its design stands beside."""
    store = tmp_path / "rows.db"
    swept(design, "--store", store)
    name = run("runs", "list", "--json").json["runs"][0]["id"]
    assert run("explore", store, "--out", tmp_path / "a", "--quiet").code == 0
    ao.sweep(design, ["cylinder.bore=21..22 mm:2"], store=store)
    result = run("explore", name, "--out", tmp_path / "b", "--json")
    assert [Path(one["path"]).name for one in result.json["files"]] == [
        "rows_explore.html", "rows_explore_base.yaml",
    ]  # fmt: skip
    assert digests(tmp_path / "a") == digests(tmp_path / "b")
    assert run("explore", folder / f"{name}.run", "--out", tmp_path / "b", "--quiet").code == 0
    assert "no run" in told("explore", "20240101")
    assert "one study" in told("explore", name, "--study", "1")
    assert run("optimise", design, "--json").code == 0
    assert "is a run of optimise" in told("explore", "last")
    assert "no convergence" in told("runs", "show", name, "--out", tmp_path / "c")
    assert "no single best design" in told("compare", name, design)


def test_a_front_goes_through_its_record(folder, design, tmp_path):
    """The same front to the last digit; pages, figure and CSV to the byte, nothing solved."""
    made, again = tmp_path / "made", tmp_path / "again"
    made.mkdir()
    more = ["--set", "load.mass=21 kg", "--report", "--csv", made / "small_pareto.csv"]
    printed = front(design, *more, "--out", made, "--date", "2025-02-03")
    back = ao.restore("last").result
    assert isinstance(back, ParetoFront)
    assert back.to_dict() == {k: v for k, v in printed.items() if k != "files"}
    shown = run("runs", "show", "last", "--json").json
    assert (shown["points"], shown["status"]) == (5, "front")
    assert shown["result"]["points"] == printed["points"]
    knee = printed["points"][printed["knee"]["index"]]["metrics"]
    assert shown["knee"] == {name: knee[name] for name in ("mass", "stiffness_min")}
    text = run("runs", "show", "last").out
    assert all(words in text for words in ("mass min", "stiffness_min max", "knee"))
    assert "5 designs" in run("runs", "list").out
    design.unlink()
    result = run("report", "last", "--out", again)
    assert result.code == 0, result.err
    assert digests(made) == digests(again)


def test_a_front_is_not_solved_to_be_shown(folder, design, tmp_path, monkeypatch):
    """Neither its report nor its page of designs searches; these are those of the front."""
    printed = front(design)
    monkeypatch.setattr("actuator_opt.optimisation.pareto.front", None)
    assert run("report", "last", "--out", tmp_path / "r", "--quiet").code == 0
    assert run("explore", "last", "--out", tmp_path / "e", "--quiet").code == 0
    page = (tmp_path / "e" / "small_pareto_explore.html").read_text("utf-8")
    data = json.loads(re.search(r'id="data">(.*?)</script>', page, re.DOTALL)[1])
    assert data["rows"] == len(printed["points"])
    assert "5 of these meet every requirement" in data["summary"]
    across, up = (data["columns"][data["start"][key]]["name"] for key in "xy")
    assert (across, up) == ("mass", "stiffness_min")
    base = tmp_path / "e" / "small_pareto_explore_base.yaml"
    point = printed["points"][0]
    evaluated = ao.evaluate(ao.read(base, set=point["variables"]))
    assert evaluated.metrics["mass"].value == pytest.approx(point["metrics"]["mass"], rel=1e-9)


def test_a_front_of_nothing_is_recorded(folder, design):
    """An infeasible design leaves its reason; there is nothing to report or to explore."""
    given = ["--set", "requirements.stiffness_min.min=600 kN/mm"]
    assert run("pareto", design, *BOTH, *given, "--json").code == 1
    assert run("runs", "list", "--json").json["runs"][0]["status"] == "infeasible"
    assert "600 kN/mm" in run("runs", "show", "last").out
    done = run("report", "last")
    assert (done.code, done.out) == (1, "")
    assert done.err.startswith("no front: no design meets all requirements")
    assert "no front" in told("explore", "last")


def test_rerun_repeats_a_front(folder, design, tmp_path):
    """From the PDF alone: the same bytes; another result is named."""
    printed = front(design, "--report", "--out", tmp_path / "a", "--seed", 2)
    design.unlink()
    pdf = tmp_path / "a" / "small_pareto.pdf"
    result = run("rerun", pdf, "--json", "--out", tmp_path / "b")
    assert (result.code, result.err) == (0, "")
    data = result.json
    assert data["rerun"]["repeats"] is True
    assert data["points"] == printed["points"]
    assert digests(tmp_path / "a") == digests(tmp_path / "b")
    assert [one["kind"] for one in run("runs", "list", "--json").json["runs"]] == ["pareto"] * 2
    assert run("rerun", pdf, "--no-record", "--quiet").out == ""
    assert len(list(folder.iterdir())) == 2


@pytest.mark.long
def test_own_metrics_travel_with_the_record(folder, design, tmp_path, monkeypatch):
    """From any folder; a changed plugin is told, one named by the person is taken."""
    plugin = tmp_path / "own.py"
    plugin.write_text(OWN)
    monkeypatch.chdir(tmp_path)
    store = tmp_path / "rows.db"
    more = ["--plugin", "own.py", "--store", store, "--csv", "rows.csv"]
    swept(design, *more, "--figure", "parallel", "--show", "slenderness", "--out", "made")
    monkeypatch.chdir("/")
    for verb in ("report", "explore"):
        assert "name it with --plugin to run it" in told(verb, "last", "--out", tmp_path / "c")
    named = ["--plugin", plugin, "--quiet"]
    assert run("report", "last", "--out", tmp_path / "again", *named).code == 0
    found = digests(tmp_path / "again")
    assert found.pop("test_bench-sweep.csv") == digest(tmp_path / "rows.csv")
    assert found == digests(tmp_path / "made")
    assert run("explore", "last", "--out", tmp_path / "page", *named).code == 0
    plugin.write_text(OWN + "\n")
    for verb in ("report", "explore"):
        again = run(verb, "last", "--plugin", plugin, "--out", tmp_path / verb)
        assert again.code == 0
        assert f"was made with another version of {plugin} (its SHA-256 differs)" in again.err
    assert not (tmp_path / "c").exists()


@pytest.mark.long
def test_a_sweep_by_an_own_metric(folder, design, tmp_path):
    """As objective and as requirement, whatever varies: numbers, texts, temperatures set apart."""
    plugin = tmp_path / "own.py"
    plugin.write_text(OWN)
    text = SMALL.replace("minimise: mass", "minimise: slenderness")
    design.write_text(
        text.replace("requirements:\n", "requirements:\n  slenderness:\n    max: 9\n")
    )
    more = ["--vary", "fluid.temperature=20,95 degC", "--figure", "ucurves", "--out", tmp_path]
    found = swept(design, "--plugin", plugin, "--store", tmp_path / "rows.db", *more)
    assert found["failed"] == 0
    best = found["best"][0]
    stroke = ao.read(design, plugins=[plugin]).design.cylinder.stroke
    slender = stroke / best["variables"]["cylinder.bore"]
    assert best["metrics"]["slenderness"] == pytest.approx(slender, rel=1e-12)
    assert run("runs", "show", "last").code == 0
    assert run("report", "last", "--out", tmp_path, "--plugin", plugin).code == 0


@pytest.mark.parametrize("kind", ["file", pytest.param("device", marks=pytest.mark.long)])
def test_no_record_costs_no_result(tmp_path, design, kind):
    """Standard error says why, standard output and the exit status stay; --no-record is silent."""
    (tmp_path / "file").write_text("")
    place = {"file": str(tmp_path / "file"), "device": "/dev/full"}[kind]
    where = {"ACTUATOR_OPT_RUNS": place}
    for words in (["sweep", design, *VARY], ["pareto", design, *BOTH, "-n", 3, "--checks", 0]):
        result = run(*words, "--json", environment=where)
        assert result.code == 0
        assert "mass" in result.json.get("points", result.json.get("best"))[0]["metrics"]
        assert len(result.err.splitlines()) == 1
        assert "--no-record" in result.err
        assert run(*words, "--json", "--no-record", environment=where).err == ""


def test_damaged_records_of_studies(folder, design, tmp_path):
    """One clear line from every command, never a traceback."""
    swept(design, "--store", tmp_path / "rows.db")
    (path,) = folder.iterdir()
    head, body = path.read_text().splitlines()
    data = json.loads(body)
    for key in ("plan", "asked", "input", "result"):
        other = tmp_path / f"{key}.run"
        other.write_text(head + "\n" + json.dumps({k: v for k, v in data.items() if k != key}))
        for words in (["report"], ["explore"], ["runs", "show"]):
            more = ["--out", tmp_path] if words[0] != "runs" else []
            result = run(*words, other, *more)
            assert result.code in (0, 3)
            assert len(result.err.splitlines()) <= (1 if result.code else 3)


@pytest.mark.long
def test_two_sweeps_at_once_and_one_that_is_killed(folder, design, tmp_path):
    """Each leaves its own whole record; the killed one leaves none, and its store goes on."""
    store = tmp_path / "rows.db"
    words = command("sweep", design, *VARY, "--store", store, "--json")
    where = surroundings(ACTUATOR_OPT_RUNS=str(folder))
    both = [subprocess.Popen(words, env=where, stdout=subprocess.PIPE) for _ in range(2)]
    results = [json.loads(one.communicate(timeout=60)[0]) for one in both]
    assert results[0]["best"] == results[1]["best"]
    found, faults = run_store.entries(folder)
    assert (len(found), faults) == (2, [])
    long = ["cylinder.bore=20..22 mm:400", "rod.outer_diameter=11..12 mm:400"]
    vary = [word for one in long for word in ("--vary", one)]
    killed = tmp_path / "killed.db"
    words = command("sweep", design, *vary, "--store", killed, "--workers", 1, "--quiet")
    process = subprocess.Popen(words, env=where, stdout=subprocess.DEVNULL)
    end = time.monotonic() + 60
    while time.monotonic() < end and not _rows(killed):
        time.sleep(0.05)
    process.send_signal(signal.SIGKILL)
    assert process.wait(60) == -signal.SIGKILL
    assert _rows(killed)
    assert len(list(folder.iterdir())) == 2


def _rows(path):
    """How many rows a database has; 0 while there is none."""
    if not path.exists():
        return 0
    base = sqlite3.connect(path)
    try:
        return base.execute("SELECT count(*) FROM rows").fetchone()[0]
    except sqlite3.OperationalError:
        return 0
    finally:
        base.close()


def test_a_thousand_records_are_listed_at_once(folder, design):
    """Heads alone are read: the list of many takes no longer than reading their first lines."""
    swept(design)
    (path,) = folder.iterdir()
    for k in range(1000):
        shutil.copy(path, folder / f"20260101-{k:06d}-{k:06x}.run")
    began = time.process_time()
    found, faults = run_store.entries(folder)
    assert (len(found), faults) == (1001, [])
    assert time.process_time() - began < 2.0
    assert len(run("runs", "list").out.splitlines()) == 1002


def test_a_process_of_its_own_prints_no_word_of_it(folder, design):
    """Under --json standard error stays empty."""
    done = spawn("sweep", design, *VARY, "--json", environment={"ACTUATOR_OPT_RUNS": str(folder)})
    assert (done.returncode, done.stderr) == (0, "")
    assert len(list(folder.iterdir())) == 1


def test_any_front_goes_through_json(design):
    """Infinite limits of quantities and own metrics too."""
    found = ao.pareto(design, ["mass:min", "slenderness:max"], n=3, checks=0, plugins=[_own()])
    text = json.dumps(stored_results.to_plain(found), allow_nan=False)
    back = stored_results.from_plain(ParetoFront, json.loads(text), tuple(_plugins()))
    assert back.to_dict() == found.to_dict()
    assert back.objectives == found.objectives


def _own():
    @ao.metric("slenderness")
    def slenderness(values):
        return values["cylinder.stroke"] / values["cylinder.bore"]

    return slenderness


def _plugins():
    from actuator_opt.evaluation.plugin import collect

    return collect(_own())
