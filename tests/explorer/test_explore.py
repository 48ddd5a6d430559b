"""The explorer: a kept sweep as one page, whose data, limits, sections and commands are true."""

from __future__ import annotations

import base64
import json
import re
import shlex
import shutil
import sqlite3
import subprocess
from pathlib import Path

import numpy as np
import pytest
from cases.digests import digest
from cli_runner import run
from sweep_case import KNEE, NEAR

import actuator_opt as ao
from actuator_opt.base.database import Checksums, study_checksum
from actuator_opt.base.errors import InputError, UsageError
from actuator_opt.evaluation.outline_templates import LENGTHS
from actuator_opt.sweeps.explored import BEST, explored

VARY = ["cylinder.bore=20.8..21.2 mm:4", "rod.outer_diameter=10.6..11.2 mm:3"]
EVIL = "</script><script>alert(1)</script> & \"quotes\" <!-- @DATA@ 'one'"


@pytest.fixture(scope="module")
def store(tmp_path_factory):
    """A knee whose bore, rod and its material, a limit and a number of seals vary."""
    path = tmp_path_factory.mktemp("store") / "rows.db"
    vary = [
        *VARY,
        "rod.material=steel_42crmo4,ti_6al4v",
        "requirements.stiffness_min.min=5,9.7 kN/mm",
        "seals.piston.count=1,2",
    ]
    ao.sweep(ao.read(KNEE, set=NEAR), vary, store=path)
    return path


@pytest.fixture(scope="module")
def found(store):
    """Its rows as they are read."""
    return explored(store)


@pytest.fixture(scope="module")
def text(store, tmp_path_factory):
    """The page."""
    return ao.explore(store, out=tmp_path_factory.mktemp("page"))[0].path.read_text("utf-8")


def data_of(page):
    """The data of a page."""
    found = re.search(r'<script type="application/json" id="data">(.*?)</script>', page, re.DOTALL)
    return json.loads(found[1])


def unpacked(told, kind="<f4"):
    """Numbers of a base64 text."""
    return np.frombuffer(base64.b64decode(told), dtype=kind)


def drawn(data, row):
    """Numbers of the section of a row, as the page's script finds them (mm)."""
    shapes = data["shapes"]
    template = shapes["templates"][unpacked(shapes["which"], "<i2")[row]]
    found = np.array(template["numbers"])
    for number, dimension, slope in template["slopes"]:
        found[number] += slope * unpacked(shapes["dimensions"][dimension])[row]
    return template, found


def command_of(data, row):
    """The words after `report` of a row's command."""
    words = list(data["command"])
    for one in data["exact"]:
        if "data" in one:
            value = repr(float(unpacked(one["data"], "<f8")[row]))
        else:
            value = one["texts"][unpacked(one["codes"], "<u2")[row]]
        words += ["--set", f"{one['path']}={value}"]
    return words


def test_the_page_stands_alone(text):
    """No address to load from, a policy that allows none, and little beside the data."""
    data = re.search(r'id="data">(.*?)</script>', text, re.DOTALL)[1]
    assert len(text.encode()) - len(data.encode()) < 200_000
    bare = text.replace("http://www.w3.org/2000/svg", "")  # a name space, nothing to load
    for word in ("http:", "https:", "//cdn", "@import", "url(", " src=", " href=", "fetch("):
        assert word not in bare.replace(data, ""), word
    assert "default-src 'none'" in text


def test_columns_are_the_rows_of_the_database(found, text):
    """Every number in its display unit, to the last bit of a float32."""
    data = data_of(text)
    assert data["rows"] == len(found.numbers) == 96
    study = found.study
    for column in data["columns"]:
        if column["name"] not in study.metrics:
            continue
        at = [one.name for one in study.columns].index(column["name"])
        expected = study.quantity(column["name"]).to_display(found.numbers[:, at])
        told = unpacked(column["data"]) if "data" in column else np.float32(column["value"])
        np.testing.assert_array_equal(told, np.broadcast_to(expected, 96).astype("<f4"))


def test_margins_of_the_limits_are_those_of_the_sweep(found):
    """The least of all margins is the row's, the limit it belongs to is the row's worst."""
    np.testing.assert_array_equal(found.margins.min(axis=0), found.numbers[:, -3])
    names = [limit.name for limit in found.limits]
    worst = [found.study.limits[int(k)] for k in found.numbers[:, -2]]
    assert [names[k] for k in found.margins.argmin(axis=0)] == worst


@pytest.mark.parametrize("row", [0, 17, 50, 95])
def test_a_command_gives_its_row(found, text, row):
    """The design of the command has the metrics, margins and outlines of its row."""
    data = data_of(text)
    words = command_of(data, row)
    assert words[:2] == ["actuator-opt", "report"]
    pairs = dict(word.split("=", 1) for word in words[4::2])
    alone = ao.evaluate(ao.read(data["design"], set=pairs))
    study = found.study
    for k, name in enumerate(study.metrics, len(study.order)):
        value, told = alone.metrics[name].value, found.numbers[row, k]
        assert (value is None and np.isnan(told)) or value == pytest.approx(told, rel=1e-9), name
    names = [limit.name for limit in found.limits]
    for one in alone.requirements:
        assert found.margins[names.index(one.name), row] <= one.margin + 1e-9
    template, numbers = drawn(data, row)
    points = [c for o in alone.outlines for p in o.polygons for xy in p for c in xy]
    lengths = [alone.lengths[name] for name in LENGTHS]
    np.testing.assert_allclose(numbers, 1000 * np.array([*points, *lengths]), atol=1e-4)
    assert [p["part"] for p in template["parts"]] == [o.part for o in alone.outlines]


def test_sections_follow_what_varies_in_lay_up_and_fittings(tmp_path):
    """Layers, temperatures and caps; a part whose own numbers vary is not drawn."""
    file = tmp_path / "rows.db"
    vary = [
        "barrel.layup[1].thickness=1..3 mm",
        "fluid.temperature=20..60 degC",
        "caps.thickness=4..8 mm",
    ]
    ao.sweep(KNEE, vary, method="lhs", n=12, store=file)
    data = data_of(ao.explore(file, out=tmp_path)[0].path.read_text("utf-8"))
    assert len(data["shapes"]["templates"]) == 1
    for row in (0, 11):
        pairs = dict(word.split("=", 1) for word in command_of(data, row)[4::2])
        alone = ao.evaluate(ao.read(data["design"], set=pairs))
        points = [c for o in alone.outlines for p in o.polygons for xy in p for c in xy]
        np.testing.assert_allclose(
            drawn(data, row)[1][: -len(LENGTHS)], 1000 * np.array(points), atol=1e-4
        )


@pytest.mark.long
def test_many_rows_are_thinned_evenly(tmp_path):
    """One in n by key, and the best feasible; that some are left out is told."""
    file = tmp_path / "rows.db"
    near = ["cylinder.bore=20.5..21.8 mm", "barrel.layup[1].thickness=2.6..3.4 mm"]
    ao.sweep(ao.read(KNEE, set=NEAR), near, method="sobol", n=2048, store=file)
    every, some = explored(file), explored(file, most=100)
    assert not every.thinned
    assert some.thinned
    good = np.flatnonzero(every.numbers[:, -1] == 1.0)
    best = good[np.argsort(every.best[good])][:BEST]
    kept = {row.tobytes() for row in some.numbers}
    assert {row.tobytes() for row in every.numbers[best]} <= kept
    assert -(-2048 // 21) <= len(kept) <= 100 + BEST
    page = ao.explore(file, out=tmp_path, rows=100)[0].path.read_text("utf-8")
    assert "one in 21" in data_of(page)["summary"]


def test_no_text_breaks_out_of_the_script(tmp_path):
    """Names and notes with markup stay data; a name with a space stays in one word."""
    file = tmp_path / "rows.db"
    design = ao.read(KNEE).design
    case = design.load_cases[0].model_copy(update={"name": "stance two"})
    changed = design.model_copy(
        update={"name": EVIL, "notes": EVIL, "load_cases": (case, *design.load_cases[1:])}
    )
    ao.sweep(changed, ["load_cases[stance two].force=3..5 kN:2"], store=file)
    page = ao.explore(file, out=tmp_path)[0].path.read_text("utf-8")
    assert page.count("<script") == page.count("</script>") == 2
    assert "alert(1)</script>" not in page
    data = data_of(page)
    assert data["name"] == ao.read(data["design"]).design.name
    assert "</script><script>alert(1)" in data["name"]
    words = command_of(data, 0)
    assert shlex.split(shlex.join(words)) == words


def test_columns_know_which_way_is_better(store, text):
    """By the objective, a requirement, or a metric's worst value; inputs neither way."""
    data = data_of(text)
    ways = {one["name"]: one.get("better", 0) for one in data["columns"]}
    assert (ways["mass"], ways["stiffness_min"], ways["friction_running"]) == (-1, 1, -1)
    assert (ways["closed_length"], ways["efficiency"]) == (-1, 1)
    assert ways["cylinder.bore"] == ways["rod.material"] == 0
    shown = [data["columns"][data["start"][name]]["name"] for name in "xyc"]
    assert shown == ["stiffness_min", "mass", "cylinder.bore"]


def test_the_page_without_its_data_is_small(text):
    """Markup, style and script; nothing is loaded from anywhere."""
    data = re.search(r'id="data">(.*?)</script>', text, re.DOTALL)[1]
    assert len(text.encode()) - len(data.encode()) < 200_000
    bare = text.replace(data, "")
    assert set(re.findall(r"https?://[^\s\"']+", bare)) <= {"http://www.w3.org/2000/svg"}


def test_same_input_same_bytes(store, tmp_path):
    """Twice the same, wherever it is written."""
    one = ao.explore(store, out=tmp_path / "a")
    two = ao.explore(store, out=tmp_path / "b" / "rows_explore.html")
    assert [file.sha256 for file in one] == [file.sha256 for file in two]
    assert digest(one[0].path) == digest(two[0].path)


def test_terminal_names_the_files(store, tmp_path):
    """JSON of the contract, or one line for each file."""
    done = run("explore", str(store), "--out", str(tmp_path), "--json")
    assert done.code == 0, done.err
    files = json.loads(done.out)["files"]
    assert [Path(file["path"]).name for file in files] == [
        "rows_explore.html",
        "rows_explore_base.yaml",
    ]
    assert all(set(file) == {"path", "sha256"} for file in files)
    done = run("explore", str(store), "--out", str(tmp_path / "x.html"))
    assert f"wrote {tmp_path / 'x.html'}" in done.err


def forged(store, target, study, failure):
    """A store changed by a stranger, who can write its checksums too."""
    shutil.copy(store, target)
    with sqlite3.connect(target) as base:
        base.execute(f"UPDATE studies SET {study}")
        about = base.execute("SELECT hash, name, design, columns FROM studies").fetchone()
        base.execute("UPDATE studies SET checksum = ?", (study_checksum(*about),))
        for key, numbers in base.execute("SELECT key, numbers FROM rows").fetchall():
            kept = (None if failure else numbers, failure)
            checksum = Checksums(about[0], len(numbers) // 8).of(key, *kept)
            put = "UPDATE rows SET numbers = ?, failure = ?, checksum = ? WHERE key = ?"
            base.execute(put, (*kept, checksum, key))
    base.close()


def test_wrong_input_is_one_line(store, tmp_path):
    """No file, not a store, no study, no rows, other models: where, what, what to do."""
    other = {}
    for name, statement in {
        "empty": "DELETE FROM rows",
        "none": "DELETE FROM studies",
        "old": "UPDATE meta SET value = '0.0.1' WHERE key = 'version'",
        "format": "UPDATE meta SET value = '9' WHERE key = 'format'",
        "changed": "UPDATE studies SET hash = 'x'",
        "torn": "UPDATE rows SET numbers = x'00'",
        "columns": "UPDATE studies SET columns = '{'",
    }.items():
        other[name] = tmp_path / f"{name}.db"
        shutil.copy(store, other[name])
        with sqlite3.connect(other[name]) as base:
            base.execute(statement)
        base.close()
    for name, study, row in (
        ("spelt", "columns = '{'", None),
        ("other", "hash = 'x'", None),
        ("failed", "name = name", "no <b>way</b>"),
    ):
        other[name] = tmp_path / f"{name}.db"
        forged(store, other[name], study, row)
    (tmp_path / "text.db").write_text("not a database")
    (tmp_path / "nothing.db").write_bytes(b"")
    with sqlite3.connect(tmp_path / "foreign.db") as base:
        base.execute("CREATE TABLE people (name TEXT)")
    base.close()
    cases = [
        ([str(tmp_path / "rows.d")], "no such file"),
        ([str(tmp_path)], "is a folder"),
        ([str(tmp_path / "text.db")], "is not a database of sweeps"),
        ([str(tmp_path / "nothing.db")], "is not a database of sweeps"),
        ([str(tmp_path / "foreign.db")], "is not a database of sweeps"),
        ([str(other["empty"])], "has no rows yet"),
        ([str(other["none"])], "has no study"),
        ([str(other["old"])], "has rows of model version 0.0.1"),
        ([str(other["format"])], "has the format 9"),
        ([str(other["changed"])], "study 1 is damaged"),
        ([str(other["torn"])], "its rows are damaged"),
        ([str(other["columns"])], "study 1 is damaged"),
        ([str(other["spelt"])], "does not name the columns"),
        ([str(other["other"])], "computed with other materials"),
        ([str(other["failed"])], "every design failed"),
        ([str(store), "--study", "7"], "has no study 7"),
        ([str(store), "--out", str(store / "page")], "is a file"),
    ]
    for words, told in cases:
        words = words if "--out" in words else [*words, "--out", str(tmp_path / "out")]
        done = run("explore", *words)
        assert done.code == 3, (words, done.err)
        assert told in done.err, (words, done.err)
        assert len(done.err.strip().splitlines()) == 1, done.err
    assert not (tmp_path / "out").exists()
    for words in ({"rows": 0}, {"out": "-"}):
        with pytest.raises(UsageError):
            ao.explore(store, **words)


def test_newest_study_is_shown_unless_told(store, tmp_path):
    """Two studies in one file."""
    both = tmp_path / "both.db"
    shutil.copy(store, both)
    ao.sweep(KNEE, ["cylinder.stroke=100..120 mm:3"], store=both)
    assert data_of(ao.explore(both, out=tmp_path)[0].path.read_text("utf-8"))["rows"] == 3
    again = ao.explore(both, out=tmp_path, study=1)[0].path.read_text("utf-8")
    assert data_of(again)["rows"] == 96


def test_own_metrics_need_their_file(tmp_path):
    """Without --plugin the rows cannot be told; with it they can, and the command has it."""
    own = tmp_path / "own.py"
    own.write_text(
        "import actuator_opt as ao\n\n\n"
        "@ao.constraint('slim')\n"
        "def slim(v):\n    return 22e-3 - v['cylinder.bore']\n"
    )
    file = tmp_path / "rows.db"
    ao.sweep(KNEE, ["cylinder.bore=20..24 mm:3"], store=file, plugins=[own])
    with pytest.raises(InputError, match="own"):
        ao.explore(file, out=tmp_path)
    page = ao.explore(file, out=tmp_path, plugins=[own])[0].path.read_text("utf-8")
    data = data_of(page)
    assert data["command"][-2:] == ["--plugin", "own.py"]
    slim = next(one for one in data["limits"] if one["name"] == "slim")
    rooms = {one["plain"]: one["reserve"] for one in data["limits"]}  # below it: no reserve
    assert rooms == {True: 1e-6, False: 1e-3}
    np.testing.assert_allclose(unpacked(slim["margin"]), [2e-3, 0, -2e-3], atol=1e-9)


def test_the_script_is_valid(text, tmp_path):
    """JavaScript without a fault of syntax, where there is something to read it."""
    node = shutil.which("node")
    if node is None:
        pytest.skip("no node to read the page's script with")
    script = re.findall(r"<script>(.*?)</script>", text, re.DOTALL)[0]
    (tmp_path / "page.js").write_text(script, encoding="utf-8")
    done = subprocess.run(
        [node, "--check", str(tmp_path / "page.js")], capture_output=True, check=False
    )
    assert done.returncode == 0, done.stderr.decode()
