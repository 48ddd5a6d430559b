"""Run records: complete, atomic, never in the way, and reports out of them without solving."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import threading
from math import inf
from pathlib import Path

import pytest
from cases.digests import digests
from cli_runner import PLIES, bench, command, run, surroundings

import actuator_opt as ao
from actuator_opt.base import runs as run_store
from actuator_opt.optimisation import stored_results
from actuator_opt.optimisation.result import Optimisation
from actuator_opt.optimisation.run import optimise as solver_entry
from actuator_opt.pages.trust import convergence_figure
from actuator_opt.rendering.ink import Ink

pytestmark = pytest.mark.usefixtures("searched_once")
WALL = "  retention.wall:\n    lower: 1 mm\n    upper: 10 mm\n"
SMALL = bench((WALL, ""), *PLIES)


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A runs folder of the test's own."""
    place = tmp_path / "runs"
    monkeypatch.setenv("ACTUATOR_OPT_RUNS", str(place))
    monkeypatch.delenv("ACTUATOR_OPT_NO_RECORD", raising=False)
    return place


@pytest.fixture
def design(tmp_path):
    """A small design file."""
    path = tmp_path / "small.yaml"
    path.write_text(SMALL)
    return path


def optimised(design, *options):
    """One optimisation, recorded."""
    result = run("optimise", design, "--json", *options)
    assert result.code in (0, 1), result.out
    return result


def test_a_record_holds_the_whole_run(folder, design):
    """Input, overrides, versions, seed, hash, trace and the JSON result, as the command gave it."""
    printed = optimised(design, "--set", "load.mass=21 kg", "--seed", 3).json
    (path,) = folder.iterdir()
    shown = run("runs", "show", "last", "--json").json
    assert shown["id"] == path.stem
    assert shown["input"]["text"] == SMALL
    assert shown["input"]["set"] == [["load.mass", "21 kg"]]
    assert shown["command"] == f"actuator-opt optimise {design} --set 'load.mass=21 kg' --seed 3"
    assert (shown["seed"], shown["kind"], shown["name"]) == (3, "optimise", "test bench")
    assert shown["spec_hash"] != printed["spec_hash"]  # of the input, not of the optimum
    assert shown["spec_hash"] == ao.evaluate(ao.read(design, set={"load.mass": 21.0})).spec_hash
    assert shown["result"] == printed
    assert shown["objective"] == printed["objective"]
    assert shown["variables"] == {k: v["value"] for k, v in printed["variables"].items()}
    assert shown["versions"]["actuator-opt"] == ao.__version__
    assert {"python", "numpy", "scipy", "nlopt"} <= set(shown["versions"])
    last = shown["trace"][-1]
    assert last[1] == pytest.approx(printed["objective"]["value"], rel=1e-6)
    assert last[2] <= 1e-6


@pytest.mark.parametrize(
    "options",
    [
        pytest.param((), marks=pytest.mark.long),
        pytest.param(("--standard-sizes",), marks=pytest.mark.long),
        ("--date", "2025-02-03"),
    ],
)
def test_its_report_is_the_report_of_the_command(folder, design, tmp_path, options, monkeypatch):
    """The same bytes, and nothing is solved."""
    made, again = tmp_path / "made", tmp_path / "again"
    optimised(design, "--starts", 1, "--report", "--out", made, *options)
    design.unlink()
    monkeypatch.setattr("actuator_opt.optimisation.run.optimise", None)
    result = run("report", "last", "--out", again)
    assert result.code == 0, result.err
    assert digests(made) == digests(again)


@pytest.mark.long
def test_infeasible_and_chosen_designs_are_reported_again(folder, tmp_path):
    """The card of an impossible design and the table of choices stand in the record too."""
    cases = {
        "impossible": SMALL.replace("min: 6 kN/mm", "min: 600 kN/mm"),
        "sized": SMALL.replace("max: 60 um", "max: 60 um\n  mass:\n    max: 100 kg")
        .replace(
            "    lower: 20 mm\n    upper: 30 mm",
            "    lower: 20 mm\n    upper: 30 mm\n    sizes: [29 mm, 30 mm]",
        )
        .replace("max: 500 N", "max: 420 N"),
        "chosen": SMALL + "\nchoices:\n  seals.rod.section: [1.78 mm, 2.62 mm]\n",
    }
    for name, text in cases.items():
        path = tmp_path / f"{name}.yaml"
        path.write_text(text)
        code = optimised(path, "--starts", 1, "--report", "--out", tmp_path / name / "a").code
        assert run("report", "last", "--out", tmp_path / name / "b").code == code
        assert run("runs", "list", "--json").json["runs"][0]["met"] == (code == 0)
        assert digests(tmp_path / name / "a") == digests(tmp_path / name / "b")


@pytest.mark.long
def test_own_metrics_come_back_where_their_file_is_named(folder, design, tmp_path):
    """A record by itself runs no program; a changed plugin is no silent change of the report."""
    plugin = tmp_path / "own.py"
    text = (
        "import actuator_opt as ao\n@ao.metric('slenderness')\n"
        "def own(v):\n    return v['cylinder.stroke'] / v['cylinder.bore']\n"
    )
    plugin.write_text(text)
    optimised(design, "--plugin", plugin, "--starts", 1, "--report", "--out", tmp_path / "a")
    refused = run("report", "last", "--out", tmp_path / "b", "--json")
    assert refused.code == 3
    assert refused.errors[0]["message"].startswith(f"its custom metrics came from {plugin}")
    assert refused.errors[0]["remedy"] == "name it with --plugin to run it"
    named = run("report", "last", "--out", tmp_path / "b", "--plugin", plugin)
    assert (named.code, named.err.count("SHA-256")) == (0, 0)
    assert digests(tmp_path / "a") == digests(tmp_path / "b")
    plugin.write_text(text + "\n")
    named = run("report", "last", "--out", tmp_path / "c", "--plugin", plugin)
    assert named.code == 0
    assert f"was made with another version of {plugin} (its SHA-256 differs)" in named.err
    assert digests(tmp_path / "a") == digests(tmp_path / "c")


def test_an_optimisation_goes_through_json_and_back():
    """Every field is the same after the way through text, infinite numbers too."""
    found = ao.optimise(ao.read(SMALL), standard_sizes=True)
    text = json.dumps(stored_results.to_plain(found), allow_nan=False)
    back = stored_results.from_plain(Optimisation, json.loads(text))
    for name in found.__dataclass_fields__:
        if name not in ("evaluation", "start", "rounding"):
            assert getattr(back, name) == getattr(found, name), name
    assert back.to_dict() == found.to_dict()
    worse = ao.Run("x", Path("x"), {}, {})
    assert worse.to_dict() == {"id": "x", "path": "x"}
    odd = stored_results.to_plain(found.__class__(**_fields(found) | {"objective_value": inf}))
    assert (
        stored_results.from_plain(Optimisation, json.loads(json.dumps(odd))).objective_value == inf
    )


def _fields(found):
    return {name: getattr(found, name) for name in found.__dataclass_fields__}


def test_lists_filter_and_order(folder, design):
    """Newest first; by design, file or command; and what cannot be read is said."""
    optimised(design)
    optimised(design, "--set", "name=other one")
    names = [one["name"] for one in run("runs", "list", "--json").json["runs"]]
    assert names == ["other one", "test bench"]
    for words, count in {
        ("--design", "test bench"): 1, ("--design", "small"): 2, ("--design", "small.yaml"): 2,
        ("--design", "knee"): 0, ("--command", "optimize"): 2, ("--command", "sweep"): 0,
    }.items():  # fmt: skip
        assert len(run("runs", "list", *words, "--json").json["runs"]) == count, words
    (folder / "20200101-000000-abcdef.run").write_text("{")
    (folder / "20200101-000000-abcdee.run").write_bytes(b"\xff\x00")
    (folder / "notes.txt").write_text("mine")
    told = run("runs", "list", encoding="ascii")
    assert told.code == 0
    assert told.err.count("is not a record of a run, or is damaged") == 2
    assert len(told.out.splitlines()) == 3
    assert max(map(len, run("runs", "list", environment={"COLUMNS": "60"}).out.splitlines())) <= 60


def test_names_of_runs(folder, design):
    """An id, its beginning, last, the file itself; none and several are refused in a line."""
    none = run("runs", "show", "last", "--json")
    assert (none.code, none.errors[0]["message"]) == (3, "no run is recorded yet")
    epoch = {"SOURCE_DATE_EPOCH": "1700000000"}
    for _ in range(2):
        assert run("optimise", design, "--json", environment=epoch).code == 0
    first, second = sorted(path.stem for path in folder.iterdir())
    assert first.startswith("20231114-221320-")
    assert run("runs", "show", first[:-1], "--json").json["started"] == "2023-11-14T22:13:20Z"
    assert run("runs", "show", folder / f"{second}.run", "--json").json["id"] == second
    several = run("runs", "show", "2023", "--json")
    assert several.code == 3
    assert "several runs begin with" in several.errors[0]["message"]
    for name in ("nothing", "", "/no/such.run", "2024"):
        assert run("runs", "show", name, "--json").code == 3, name
    assert run("report", "2024", "--json").code == 3


def test_two_prunes_at_once(tmp_path, monkeypatch):
    """A record that another process has deleted meanwhile is no fault, and not told as deleted."""
    for _ in range(3):
        run_store.write(tmp_path, "20261122-104500", {"kind": "sweep"}, {})
    listed = run_store.entries(tmp_path)
    newest, gone, left = listed[0]
    monkeypatch.setattr(run_store, "entries", lambda place: listed)
    gone.path.unlink()
    assert ao.prune_runs(keep=1, folder=tmp_path) == [left.id]
    assert [path.stem for path in tmp_path.iterdir()] == [newest.id]


def test_deleting_is_asked_for(folder, design):
    """One by its id, all but the newest; never by "last", never another file."""
    for _ in range(3):
        optimised(design)
    newest = run("runs", "list", "--json").json["runs"][0]["id"]
    assert run("runs", "delete", "last").code == 2
    assert run("runs", "delete", design, "--json").code == 3
    assert design.exists()
    assert len(run("runs", "prune", "--keep", 2, "--json").json["deleted"]) == 1
    assert len(list(folder.iterdir())) == 2
    assert run("runs", "delete", newest).err == f"deleted {newest}\n"
    assert run("runs", "delete", newest).code == 3
    assert run("runs", "prune", "--keep", -1).code == 2
    assert len(run("runs", "prune", "--keep", 0, "--json").json["deleted"]) == 1
    assert list(folder.iterdir()) == []
    assert run("runs", "list").err.startswith("no runs are recorded in ")


@pytest.mark.parametrize("kind", ["file", "below a file", "device"])
def test_a_folder_that_cannot_be_costs_one_line(tmp_path, design, kind):
    """The command does all it should; standard error says why there is no record."""
    (tmp_path / "file").write_text("")
    place = {
        "file": tmp_path / "file", "below a file": tmp_path / "file" / "x", "device": "/dev/full",
    }[kind]  # fmt: skip
    result = run("optimise", design, "--json", environment={"ACTUATOR_OPT_RUNS": str(place)})
    assert result.code == 0
    assert result.json["status"] == "optimal"
    assert len(result.err.splitlines()) == 1
    assert "--no-record" in result.err


def test_records_can_be_switched_off(folder, design):
    """By option and by environment variable; what they are is left out of the command line."""
    optimised(design, "--no-record")
    assert not folder.exists()
    off = {"ACTUATOR_OPT_NO_RECORD": "1"}
    assert run("optimise", design, "--json", environment=off).code == 0
    assert not folder.exists()
    assert "ACTUATOR_OPT_NO_RECORD is set" in run("runs", "list", environment=off).err
    assert run("runs", "show", "last", environment=off).code == 3
    assert ao.record(ao.optimise(ao.read(SMALL), prices=False), actuator=ao.read(SMALL)) is not None
    assert len(list(folder.iterdir())) == 1


def test_the_folder_is_the_persons_own(monkeypatch, tmp_path):
    """XDG_DATA_HOME where it is a whole path, else the home folder."""
    monkeypatch.delenv("ACTUATOR_OPT_RUNS")
    monkeypatch.setattr(sys, "platform", "linux")
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path))
    assert run_store.folder() == tmp_path / "actuator-opt" / "runs"
    monkeypatch.setenv("XDG_DATA_HOME", "not/whole")
    monkeypatch.setenv("HOME", str(tmp_path / "home"))
    assert run_store.folder() == tmp_path / "home/.local/share/actuator-opt/runs"


def test_many_writers_at_once(tmp_path):
    """Threads and a process write side by side; no record is lost, none is partial."""

    def write():
        for k in range(20):
            run_store.write(tmp_path, "20260101-000000", {"k": k}, {"x": "y" * 5000})

    threads = [threading.Thread(target=write) for _ in range(4)]
    other = subprocess.Popen(
        [sys.executable, "-c",
         "import sys; from pathlib import Path; from actuator_opt.base import runs as run_store\n"
         "for k in range(20): run_store.write(Path(sys.argv[1]), '20260101-000000', {}, {})",
         str(tmp_path)],
        env=surroundings(),
    )  # fmt: skip
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert other.wait(60) == 0
    found, faults = run_store.entries(tmp_path)
    assert (len(found), faults) == (100, [])
    assert not list(tmp_path.glob("*.part"))
    assert all(run_store.read(entry.path) for entry in found)


def test_a_name_is_never_taken_twice(tmp_path, monkeypatch):
    """Where the random part repeats, the older record stays; also without hard links."""
    for links in (True, False):
        place = tmp_path / str(links)
        parts = iter(["aaaaaa", "aaaaaa", "bbbbbb"])
        monkeypatch.setattr(run_store, "_random", lambda _, parts=parts: next(parts))
        if not links:
            monkeypatch.setattr(os, "link", _no_links)
        for k in range(2):
            run_store.write(place, "20260101-000000", {"k": k}, {})
        heads = {path.stem[-6:]: run_store.read(path)[0]["k"] for path in place.iterdir()}
        assert heads == {"aaaaaa": 0, "bbbbbb": 1}


def forged(path, head, body):
    """A record of a stranger, who can write its checksums too."""
    made = run_store.write(path.parent, "20260101-000000", head, body)
    made.replace(path)
    return path


def _no_links(*_):
    raise PermissionError("no links here")


def test_damaged_newer_and_foreign_records(folder, design, tmp_path):
    """One clear line each, from show and from report."""
    optimised(design)
    (path,) = folder.iterdir()
    text = path.read_text()
    head = text.splitlines()[0]
    cases = {
        "is not a record of a run": ["", "[]\n{}", "{}", "\x00\x01", head, head + "\n{}"],
        "in a newer format": [('"record": 2', '"record": 3')],
        "damaged": [('"kind": "optimise"', '"kind": "sweep"'), ('"state"', '"State"')],
        "does not fit this version": [('"samples"', '"Samples"')],
        "can be restored": [('"kind": "optimise"', '"kind": "simulate"')],
    }
    parts = [json.dumps(part) for part in run_store.read(path)]
    other = tmp_path / "x.run"
    for words, texts in cases.items():
        for changed in texts:
            if isinstance(changed, str):
                other.write_text(changed)
            else:
                forged(other, *(json.loads(part.replace(*changed)) for part in parts))
            result = run("report", other, "--out", tmp_path / "out", "--json")
            assert result.code == 3, (words, changed[:80])
            assert words in result.errors[0]["message"], result.out
            assert result.errors[0]["file"] == str(other)
    assert not (tmp_path / "out").exists()
    assert run("report", path, "--set", "load.mass=3 kg").code == 2


def test_other_models_are_not_passed_off_as_then(folder, design, tmp_path):
    """A record whose numbers today's models do not repeat says so."""
    optimised(design)
    (path,) = folder.iterdir()
    head, body = run_store.read(path)
    body["result"]["metrics"]["mass"]["value"] *= 1.001
    forged(path, head | {"version": "0.0.1"}, body)
    told = run("report", path, "--out", tmp_path / "out").err
    assert "was made by actuator-opt 0.0.1" in told
    assert "mass" in told


def test_convergence_of_any_search_can_be_drawn(folder, design, tmp_path):
    """From a thousand steps to none; labels stay on the paper; the same bytes."""
    optimised(design)
    for place in ("a", "b"):
        result = run("runs", "show", "last", "--out", tmp_path / place, "--json")
        assert [Path(one["path"]).suffix for one in result.json["files"]] == [".png", ".svg"]
    assert digests(tmp_path / "a") == digests(tmp_path / "b")
    traces = [
        [], [(1, 0.2, 0.0)], [(1, 0.0, 5e3), (9, 1e-9, 0.0)], [(1, -3.0, 0.1), (2, -5.0, 1e-9)],
        [(k + 1, 1e6 / (k + 1), 10.0 ** (-k / 100)) for k in range(1000)],
    ]  # fmt: skip
    for trace in traces:
        for metric in ("mass", "stiffness_min", "weighted", "own"):
            ink: Ink = convergence_figure(trace, metric, 5000, "a long name " * 20)
            for words, left, top, right, bottom in ink.text_boxes():
                inside = left >= -0.1 and right <= ink.width and top >= 0 and bottom <= ink.height
                assert inside, (words, left, top, right, bottom)


def test_a_maximised_objective_is_traced_as_it_is_stated():
    """Its own sign, rising to the optimum; the last point may miss a limit by 1e-6."""
    text = SMALL.replace("minimise: mass", "maximise: stiffness_min").replace(
        "requirements:", "requirements:\n  mass:\n    max: 1 kg"
    )
    found = ao.optimise(ao.read(text), prices=False, starts=2)
    assert found.trace[-1][1] == pytest.approx(found.objective_value, rel=1e-5)
    assert found.objective_value > 0
    assert solver_entry is not None


def test_interrupted_or_not_the_command_ends_as_before(folder, design):
    """A process of its own leaves a record and prints no word of it under --json."""
    done = subprocess.run(
        command("optimise", design, "--json"), capture_output=True, text=True, timeout=60,
        check=False, env=surroundings(ACTUATOR_OPT_RUNS=str(folder)),
    )  # fmt: skip
    assert (done.returncode, done.stderr) == (0, "")
    assert len(list(folder.iterdir())) == 1
