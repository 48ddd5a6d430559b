"""A sweep: every row is the evaluation of its design, the best are the best, nothing is lost."""

from __future__ import annotations

import csv
import math
import os
import shutil
import signal
import sqlite3
import struct
import subprocess
import sys
import time
import tracemalloc
from concurrent.futures import ProcessPoolExecutor
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest
from cases.digests import digest
from cli_runner import run as cli
from sweep_case import KNEE, NEAR, STEEL, WAYS

import actuator_opt as ao
from actuator_opt.base.database import NumberColumn, StoredNumbers, opened
from actuator_opt.base.errors import InputError, UsageError
from actuator_opt.evaluation import compute
from actuator_opt.optimisation.actuator import goal_of
from actuator_opt.sweeps import Swept, chunk, run


@pytest.fixture(scope="module")
def knee():
    """A knee some of whose neighbours meet everything."""
    return ao.read(KNEE, set=NEAR)


def table(path):
    """Rows of a CSV."""
    with Path(path).open(encoding="utf-8") as stream:
        return list(csv.DictReader(stream))


@pytest.mark.parametrize(
    "vary",
    [
        ["cylinder.bore=18..26 mm:3", "rod.material=steel_42crmo4,ti_6al4v"],
        pytest.param(
            ["barrel.layup[2].angle=20..50 deg:2", "supply.pressure=150..220 bar:2"],
            marks=pytest.mark.long,
        ),
        pytest.param(
            ["fluid.temperature=20..60 degC:2", "fluid.material=iso_vg_32,iso_vg_46"],
            marks=pytest.mark.long,
        ),
        ["environment.temperature_max=60..90 degC:2", "fluid.air_content=0..2 %:2"],
        ["load_cases[stance].force=3..6 kN:2", "requirements.stiffness_min.min=5,20 kN/mm"],
        ["materials.steel_42crmo4.youngs_modulus=190..220 GPa:2", "seals.piston.count=1,2"],
    ],
)
def test_rows_are_the_evaluations_of_their_designs(vary, tmp_path):
    """Each variant, read and evaluated by itself, has the metrics and verdict of its row."""
    file = tmp_path / "rows.csv"
    swept = ao.sweep(KNEE, vary, csv=file)
    found = table(file)
    assert swept.requested == swept.computed == len(found)
    for number, row in enumerate(found):
        values = {path: str(value) for path, value in swept.study.values(number).items()}
        alone = ao.evaluate(ao.read(KNEE, set=values))
        for name, metric in alone.metrics.items():
            quantity = swept.study.quantity(name)
            head = f"{name} [{quantity.unit}]" if quantity.unit else name
            cell = row[head]
            assert (cell == "") == (metric.value is None), (name, values)
            if metric.value is not None:
                assert float(cell) == pytest.approx(quantity.to_display(metric.value), rel=1e-7)
        met = all(one.met for one in alone.requirements)
        missed = [check for check in alone.checks if check.status == "missed"]
        assert (row["feasible"] == "yes") == (met and not missed), values


def test_the_best_are_those_of_all_rows(knee, tmp_path):
    """Of 300 variants the best feasible ones by the objective, in order, however many processes."""
    file = tmp_path / "rows.csv"
    swept = ao.sweep(knee, WAYS, method="sobol", n=300, seed=1, csv=file, keep=5)
    masses = sorted(float(row["mass [g]"]) for row in table(file) if row["feasible"] == "yes")
    assert len(masses) == swept.feasible > 5
    best = [swept.metrics(one)["mass"] for one in swept.best]
    assert [1000 * mass for mass in best] == pytest.approx(masses[:5], rel=1e-8)
    again = ao.sweep(knee, WAYS, method="sobol", n=300, seed=1, keep=5, reduce=True)
    assert [one.number for one in again.best] == [one.number for one in swept.best]


MORE = {
    "dimensions": [],
    "materials": ["rod.material=steel_42crmo4,ti_6al4v"],
    "pressures": ["supply.pressure=195..210 bar"],
    "limits": ["requirements.stiffness_min.min=4..6 MN/m", "load_cases[stance].force=5000..5500 N"],
    "temperatures": ["fluid.temperature=30,40,50 degC"],
    "plies": ["materials.t700_epoxy.youngs_modulus_1=120..135 GPa", "supply.proof_ratio=1.4,1.5"],
}


@pytest.mark.long
@pytest.mark.parametrize("more", MORE)
def test_a_screen_loses_none_of_the_best(more, monkeypatch):
    """The best of a reduced sweep are those of all rows, found in chunks with a falling limit."""
    monkeypatch.setattr(run, "REDUCED", 256)
    monkeypatch.setattr(chunk, "LEAST_SCREENED", 100)
    screened_and_whole_agree(more, "numpy")


@pytest.mark.skipif(not find_spec("jax"), reason="the extra jax is not installed")
def test_another_engine_finds_the_same():
    """With JAX the same designs come out, to the bit; it is kept out of this process's forks."""
    script = (
        "import sys; sys.path[0:0] = ['tests/sweeps', 'tests/cases']\n"
        "import test_sweep as t\n"
        "t.run.REDUCED, t.chunk.WORTH = 256, 100\n"
        "for more in ('dimensions', 'limits'): t.screened_and_whole_agree(more, 'jax')\n"
        "assert 'jax' in sys.modules\n"
    )
    command = [sys.executable, "-c", script]
    subprocess.run(command, check=True, capture_output=True, timeout=120)


def screened_and_whole_agree(more: str, engine: str) -> None:
    """Sweep the same designs for their best and whole."""
    near = ao.read(KNEE, set=NEAR)
    vary = [
        "cylinder.bore=20.8..21.2 mm", "barrel.layup[1].thickness=2.4..3.4 mm",
        "retention.length=18..20 mm", "rod.inner_diameter=4..6 mm",
    ]  # fmt: skip
    vary += MORE[more]
    how = {"method": "lhs", "n": 2000, "seed": 4, "keep": 7}
    every = ao.sweep(near, vary, **how)
    reduced = ao.sweep(near, vary, reduce=True, engine=engine, **how)
    assert reduced.to_dict()["engine"] == engine
    assert every.feasible >= 7
    assert reduced.computed == reduced.requested == 2000
    assert reduced.screened > 500
    assert [one.number for one in reduced.best] == [one.number for one in every.best]
    for one, other in zip(reduced.best, every.best, strict=True):
        assert one.objective == other.objective


def aimed(tmp_path, objective, limits=()):
    """The knee with room at every limit and another objective."""
    file = tmp_path / "aimed.yaml"
    text = Path(KNEE).read_text(encoding="utf-8")
    assert text.count("minimise: mass") == 1
    file.write_text(text.replace("minimise: mass", objective), encoding="utf-8")
    return ao.read(file, set=NEAR | dict(limits))


@pytest.mark.parametrize(
    ("objective", "limit"),
    [
        ("minimise: efficiency", {}),
        ("maximise: end_stop_pressure", {"requirements.end_stop_pressure.max": "250 bar"}),
        pytest.param("maximise: push_force", {}, marks=pytest.mark.long),
    ],
)
def test_rows_and_screen_show_the_objective_of_the_optimiser(
    objective, limit, tmp_path, monkeypatch
):
    """Also where the objective's worst case is not the metric's own, or not that of a limit."""
    monkeypatch.setattr(run, "REDUCED", 256)
    monkeypatch.setattr(chunk, "LEAST_SCREENED", 100)
    design = aimed(tmp_path, objective, limit)
    vary = [*WAYS, "rod.outer_diameter=10.8..11.2 mm", "piston.length=9..12 mm"]
    how = {"method": "lhs", "n": 1000, "seed": 4, "keep": 7}
    every = ao.sweep(design, vary, **how)
    reduced = ao.sweep(design, vary, reduce=True, **how)
    assert every.feasible > 100
    assert reduced.screened > 100
    assert [one.number for one in reduced.best] == [one.number for one in every.best]
    metric = objective.split(": ")[1]
    best = design.changed(every.values(every.best[0]))
    subject = best.subject()
    computed, goal = compute(subject, subject.values()).computed, goal_of(subject)
    sought = goal.shown(float(goal.value(computed, subject.cases)[0]))
    shown = ao.evaluate(best).metrics[metric]
    assert sought == shown.value == pytest.approx(every.metrics(every.best[0])[metric], rel=1e-9)


def test_an_objective_without_a_value_is_refused(tmp_path):
    """A sweep by a metric that the design does not have would call any design the best."""
    with pytest.raises(InputError, match="leakage cannot be an objective here"):
        ao.sweep(aimed(tmp_path, "minimise: leakage"), WAYS, method="lhs", n=10)


def test_designs_without_a_value_of_the_objective_are_not_the_best(knee):
    """They are feasible, and stand behind every other, in one chunk and over chunks."""
    swept = ao.sweep(knee, WAYS, method="sobol", n=64, seed=1)
    study, place = swept.study, swept.study.place("mass")
    rows = study.chunk(0, 64).rows.numbers
    rows[np.arange(64) % 7 > 0, place] = np.nan
    found = Swept(study, 64)
    for first in range(0, 64, 16):
        found.add(study.judged(first, StoredNumbers(rows[first : first + 16], {}), 16), 5)
    assert found.feasible == swept.feasible > 10
    masses = rows[rows[:, -1] == 1, place]
    assert [one.objective for one in found.best] == np.sort(masses[~np.isnan(masses)])[:5].tolist()


def test_processes_do_not_change_anything(monkeypatch, tmp_path):
    """One process and three give the same bytes."""
    monkeypatch.setattr(run, "CHUNK", 64)
    files = []
    for workers in (1, 3):
        files.append(tmp_path / f"{workers}.csv")
        ao.sweep(STEEL, WAYS[:1], method="lhs", n=500, csv=files[-1], workers=workers)
    assert digest(files[0]) == digest(files[1])


def test_variants_without_a_design_are_rows_with_a_reason(tmp_path):
    """A rod as thick as the bore, walls of nothing: failed rows say why, the others stand."""
    file = tmp_path / "rows.csv"
    swept = ao.sweep(
        KNEE, ["rod.outer_diameter=12..40 mm:5", "fluid.temperature=20,40 degC"], csv=file
    )
    found = table(file)
    assert swept.failed == sum(row["failure"] != "" for row in found)
    for row in found:
        assert (row["mass [g]"] == "") == (row["failure"] != "")


def test_what_a_file_would_refuse_is_not_feasible(knee, tmp_path):
    """A thread larger than its rod passes the models, but no design file may have it."""
    file = tmp_path / "rows.csv"
    swept = ao.sweep(knee, ["rod.thread.diameter=8..12 mm:9"], csv=file)
    for number, row in enumerate(table(file)):
        values = {path: str(value) for path, value in swept.study.values(number).items()}
        try:
            ao.read(KNEE, set=NEAR | values)
        except InputError:
            assert row["failure"]
        else:
            assert row["feasible"] in ("yes", "no")


def kept(path):
    """Rows of a store by key."""
    with sqlite3.connect(path) as connection:
        return dict(connection.execute("SELECT hex(key) || study, numbers FROM rows"))


def test_a_store_gives_back_what_it_holds(tmp_path):
    """A second run computes nothing, a finer grid only what is new; both as without a store."""
    store, first, second = (tmp_path / name for name in ("s.db", "a.csv", "b.csv"))
    coarse = ao.sweep(STEEL, ["cylinder.bore=18..26 mm:5"], store=store, csv=first)
    assert (coarse.computed, coarse.reused) == (5, 0)
    again = ao.sweep(STEEL, ["cylinder.bore=18..26 mm:5"], store=store, csv=second)
    assert (again.computed, again.reused) == (0, 5)
    assert digest(first) == digest(second)
    fine = ao.sweep(STEEL, ["cylinder.bore=18..26 mm:9"], store=store, csv=first)
    assert (fine.computed, fine.reused) == (4, 5)
    ao.sweep(STEEL, ["cylinder.bore=18..26 mm:9"], csv=second)
    assert digest(first) == digest(second)
    assert len(kept(store)) == 9


def test_a_changed_design_is_another_study(tmp_path):
    """Rows of another pressure are not reused; both studies live in one file."""
    store = tmp_path / "s.db"
    ao.sweep(STEEL, ["cylinder.bore=18..26 mm:5"], store=store)
    other = ao.read(STEEL, set={"supply.pressure": "180 bar"})
    assert ao.sweep(other, ["cylinder.bore=18..26 mm:5"], store=store).computed == 5
    assert len(kept(store)) == 10


SCRIPT = """
import sys
import actuator_opt as ao
from actuator_opt.sweeps import chunk, run
run.CHUNK = 128
found = ao.sweep(sys.argv[1], sys.argv[3:], method="lhs", n=2000, store=sys.argv[2], workers=2)
print(found.requested, found.computed, found.reused)
"""


def test_a_killed_sweep_goes_on_where_it_was(tmp_path):
    """SIGKILL on the way, twice: no row lost or doubled, and the end is that of one run."""
    store, whole = tmp_path / "s.db", tmp_path / "whole.db"
    vary = ["cylinder.bore=18..26 mm", "rod.outer_diameter=9..13 mm"]
    command = [sys.executable, "-c", SCRIPT, STEEL, str(store), *vary]
    seen = 0
    for wait in (1.2, 1.7):
        process = subprocess.Popen(command, stdout=subprocess.DEVNULL, start_new_session=True)
        time.sleep(wait)
        os.killpg(process.pid, signal.SIGKILL)
        process.wait()
        with sqlite3.connect(store) as connection:
            assert connection.execute("PRAGMA integrity_check").fetchone() == ("ok",)
            tables = connection.execute("SELECT name FROM sqlite_master").fetchall()
            if ("rows",) in tables:
                count = connection.execute("SELECT count(*) FROM rows").fetchone()[0]
                assert count >= seen
                seen = count
    end = subprocess.run(command, capture_output=True, text=True, check=True)
    assert end.stdout.split() == ["2000", str(2000 - seen), str(seen)]
    ao.sweep(STEEL, vary, method="lhs", n=2000, store=whole, workers=1)
    assert kept(store) == kept(whole)


def test_a_store_that_cannot_be_used_is_said_in_one_line(tmp_path):
    """Another program's file, another version's rows, no folder: one line, nothing changed."""
    vary = ["cylinder.bore=18..26 mm:3"]
    text = tmp_path / "notes.txt"
    text.write_text("not a database, and longer than the header of one is, by some letters " * 3)
    foreign = tmp_path / "foreign.db"
    with sqlite3.connect(foreign) as connection:
        connection.execute("CREATE TABLE birds (name TEXT)")
    browser = tmp_path / "browser.db"
    with sqlite3.connect(browser) as connection:
        connection.execute("CREATE TABLE meta (key TEXT PRIMARY KEY, value TEXT)")
    old = tmp_path / "old.db"
    ao.sweep(STEEL, vary, store=old)
    with sqlite3.connect(old) as connection:
        connection.execute("UPDATE meta SET value = '0.1' WHERE key = 'version'")
    for path, words in (
        (text, "is not a database of sweeps"),
        (foreign, "another program's"),
        (browser, "another program's"),
        (old, "has rows of model version 0.1"),
        (tmp_path / "no" / "where.db", "name a file in an existing, writable folder"),
        (tmp_path, "cannot be written"),
    ):
        before = path.read_bytes() if path.is_file() else None
        with pytest.raises(InputError, match=words) as caught:
            ao.sweep(STEEL, vary, store=path)
        assert len(caught.value.diagnostics) == 1
        assert before is None or path.read_bytes() == before


@pytest.fixture(scope="module")
def three(tmp_path_factory):
    """A store of three rows, to be copied."""
    store = tmp_path_factory.mktemp("three") / "s.db"
    ao.sweep(STEEL, ["cylinder.bore=18..26 mm:3"], store=store)
    return store


@pytest.mark.parametrize(
    "change",
    [
        "numbers = x'00'",
        "numbers = 'text'",
        "numbers = NULL",
        "numbers = (SELECT numbers FROM rows WHERE id = 3)",
        "numbers = NULL, failure = 'not this one'",
        "checksum = x'0011223344556677'",
        "key = x'00112233445566778899aabbccddeeff'",
    ],
)
def test_a_damaged_row_is_computed_again(change, three, tmp_path):
    """Whoever reads the store takes no row over whose checksum does not fit, and says so."""
    store, vary = tmp_path / "s.db", ["cylinder.bore=18..26 mm:3"]
    shutil.copy(three, store)
    whole = kept(store)
    with sqlite3.connect(store) as connection:
        connection.execute(f"UPDATE rows SET {change} WHERE id = 2")
    if change == "numbers = NULL":
        page = ao.explore(store, out=tmp_path)[0]
        assert page.remarks[0].startswith("1 row is damaged and left out")
        assert "1 damaged and left out" in page.path.read_text()
    again = ao.sweep(STEEL, vary, store=store)
    assert (again.computed, again.reused) == (1, 2)
    assert again.damaged == (0 if change.startswith("key") else 1)  # found under no key, it lacks
    assert whole.items() <= kept(store).items()
    assert ao.sweep(STEEL, vary, store=store).computed == 0


def test_a_mass_changed_by_hand_is_not_taken_over(tmp_path):
    """In text, JSON and CSV: a row of -5 kg is computed again, and a line says so."""
    store, table = tmp_path / "s.db", tmp_path / "s.csv"
    words = ["sweep", STEEL, "--vary", "cylinder.bore=18..26 mm:5", "--store", store]
    words += ["--csv", table]
    first = cli(*words, "--json").json
    rows = table.read_bytes()
    place = 8 * ao.sweep(STEEL, ["cylinder.bore=18..26 mm:5"]).study.place("mass")
    with sqlite3.connect(store) as connection:
        for number, row in connection.execute("SELECT id, numbers FROM rows").fetchall():
            lighter = row[:place] + struct.pack("<d", -5.0) + row[place + 8 :]
            if number in (1, 4):
                connection.execute("UPDATE rows SET numbers = ? WHERE id = ?", (lighter, number))
    refused = cli("report", "last", "--out", tmp_path / "out", "--json")
    assert "or contains damaged rows" in refused.errors[0]["message"]
    told = cli(*words)
    assert "2 rows in the store were damaged and computed again." in told.out
    again = cli(*words, "--json").json
    assert [again[name] for name in ("computed", "reused", "damaged")] == [0, 5, 0]
    assert again["best"] == first["best"]
    assert table.read_bytes() == rows


def test_a_store_without_checksums_is_refused(three, tmp_path):
    """One of an older form: whether its rows are whole cannot be known."""
    store, vary = tmp_path / "s.db", ["cylinder.bore=18..26 mm:3"]
    shutil.copy(three, store)
    with sqlite3.connect(store) as connection:
        connection.execute("UPDATE meta SET value = '1' WHERE key = 'format'")
        connection.execute("ALTER TABLE rows DROP COLUMN checksum")
    for read in (
        lambda: ao.sweep(STEEL, vary, store=store),
        lambda: ao.explore(store, out=tmp_path),
    ):
        with pytest.raises(InputError, match="has no checksums"):
            read()


@pytest.mark.parametrize("change", ["name = 'x'", "design = ''", "columns = '[[]]'"])
def test_a_damaged_study_is_entered_anew(change, three, tmp_path):
    """What reads it refuses it; its sweep repairs it and keeps the rows."""
    store, vary = tmp_path / "s.db", ["cylinder.bore=18..26 mm:3"]
    shutil.copy(three, store)
    with sqlite3.connect(store) as connection:
        connection.execute(f"UPDATE studies SET {change}")
    with pytest.raises(InputError, match="study 1 is damaged"):
        ao.explore(store, out=tmp_path)
    assert ao.sweep(STEEL, vary, store=store).computed == 0
    assert ao.explore(store, out=tmp_path)[0].remarks == ()


@pytest.mark.parametrize("kind", ["csv", "store", "parquet"])
def test_the_design_is_not_written_over(kind, tmp_path):
    """A slip in the name of a table costs no design."""
    design = tmp_path / "d.yaml"
    text = Path(STEEL).read_bytes()
    design.write_bytes(text)
    with pytest.raises(InputError, match="is an input and would be overwritten"):
        ao.sweep(design, ["cylinder.bore=18..26 mm:3"], **{kind: design})
    assert design.read_bytes() == text


def test_a_store_called_memory_is_a_file(tmp_path, monkeypatch):
    """What SQLite would keep nowhere is kept."""
    design = Path(STEEL).resolve()
    monkeypatch.chdir(tmp_path)
    ao.sweep(design, ["cylinder.bore=18..26 mm:3"], store=":memory:")
    assert (tmp_path / ":memory:").is_file()


def test_a_long_axis_takes_no_memory():
    """Its values are found from their numbers, bit for bit those of all of them at once."""
    from actuator_opt.sweeps.plan import SweepAxis, plan

    axis = SweepAxis("p", np.array([0.018, 0.040]), range=True, count=977)
    assert (axis.numbers() == np.linspace(0.018, 0.040, 977)).all()
    long = SweepAxis("p", np.array([0.018, 0.040]), range=True, count=10**11)
    points = plan([long], method="grid", count=None).points(10**11 - 3, 8)
    assert points.numbers[0, -1] == 0.040
    assert points.numbers.shape == (1, 3)


def test_what_none_meets_is_counted_once(tmp_path):
    """Of few variants none is looked at twice."""
    few = ao.sweep(STEEL, ["cylinder.bore=18..20 mm:7"], reduce=True)
    assert sum(few.missed.values()) == 7
    many = ao.sweep(STEEL, ["cylinder.bore=18..20 mm:300"], reduce=True)
    assert sum(many.missed.values()) == 300


LIMITED = """
import resource, signal, sys
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
resource.setrlimit(resource.RLIMIT_FSIZE, (300_000, 300_000))
import actuator_opt as ao
from actuator_opt.base.errors import InputError
try:
    ao.sweep(sys.argv[1], sys.argv[3:], method="lhs", n=3000, store=sys.argv[2], workers=1)
except InputError as error:
    print(error.diagnostics[0])
"""


def test_a_full_disk_keeps_the_rows_that_stand(tmp_path):
    """A file that may not grow: one line, and the database is sound."""
    store = tmp_path / "s.db"
    vary = ["cylinder.bore=18..26 mm", "rod.outer_diameter=9..13 mm"]
    ao.sweep(STEEL, ["cylinder.bore=18..26 mm:3"], store=store)
    command = [sys.executable, "-c", LIMITED, STEEL, str(store), *vary]
    end = subprocess.run(command, capture_output=True, text=True, check=True)
    assert "stored rows are kept" in end.stdout
    with sqlite3.connect(store) as connection:
        assert connection.execute("PRAGMA integrity_check").fetchone() == ("ok",)
        assert connection.execute("SELECT count(*) FROM rows").fetchone()[0] >= 3


def test_a_million_rows_must_be_meant(tmp_path):
    """A large grid that is kept states its size and asks; a reduced one does not."""
    vary = ["cylinder.bore=18..26 mm:1200", "rod.outer_diameter=9..13 mm:1200"]
    with pytest.raises(UsageError, match="all 1 440 000 points would be evaluated in full"):
        ao.sweep(STEEL, vary, csv=tmp_path / "rows.csv")
    assert not list(tmp_path.iterdir())


def test_metrics_of_the_best_are_numbers_or_none(knee):
    """JSON has no NaN."""
    swept = ao.sweep(knee, WAYS, method="lhs", n=40)
    told = swept.to_dict()
    assert told["best"]
    for one in told["best"]:
        for value in one["metrics"].values():
            assert value is None or math.isfinite(value)
    assert np.isfinite(list(told["best"][0]["variables"].values())).all()


@pytest.mark.parametrize(
    "vary",
    [
        "barrel.layup[1].angle=85,0,88 deg",
        pytest.param("load_cases[stance].position=10 %,50 %,90 %", marks=pytest.mark.long),
        "load_cases[stance].position=10 mm,50 %,90 mm",
        pytest.param("load_cases[stance].position=10..90 mm:3", marks=pytest.mark.long),
        "load_cases[stance].speed=0.1,0,0.2 m/s",
    ],
)
def test_a_value_that_makes_another_design_between_the_ends_is_seen(vary):
    """At no angle and at no speed other models hold: the row is still its design's evaluation."""
    study = ao.sweep(KNEE, [vary]).study
    rows = study.chunk(0, 3).rows.numbers
    for number in range(3):
        alone = ao.evaluate(ao.read(KNEE, set=study.values(number)))
        for name in study.metrics:
            found, value = rows[number, study.place(name)], alone.metrics[name].value
            assert found == pytest.approx(np.nan if value is None else value, rel=1e-8, nan_ok=True)


def test_a_contradiction_between_the_ends_of_a_list_is_no_best(knee):
    """What the design's file would refuse is not feasible, wherever in the list it stands."""
    best = ao.sweep(knee, ["barrel.layup[0].thickness=1,3,1.1 mm"]).best
    found = [one.row[0] for one in best]
    for value in found:
        knee.changed({"barrel.layup[0].thickness": value})


@pytest.mark.long
def test_temperatures_that_leave_strengths_alone_move_together(tmp_path):
    """Within the environment's temperatures oil varies as an array; beyond, designs stand apart."""
    from actuator_opt.sweeps.chunk import Study

    for vary, apart in (
        ("fluid.temperature=20..60 degC:5", False),
        ("fluid.temperature=20..95 degC:5", True),
    ):
        file = tmp_path / "rows.csv"
        swept = ao.sweep(KNEE, [vary], csv=file)
        assert isinstance(swept.study, Study)
        assert bool(swept.study.designs.apart) == apart
        for number, row in enumerate(table(file)):
            (value,) = swept.study.values(number).values()
            alone = ao.evaluate(ao.read(KNEE, set={"fluid.temperature": value}))
            for name in ("friction_running", "yield_factor", "proof_factor", "damping_pipe"):
                found = next(float(row[key]) for key in row if key.split(" [")[0] == name)
                metric = alone.metrics[name]
                assert found == pytest.approx(metric.quantity.to_display(metric.value), rel=1e-8)


def test_a_path_that_no_model_reads_is_refused():
    """A constant of another law of the oil, whatever else varies."""
    law = "materials.iso_vg_32.tait_modulus=1..2 GPa:3"
    with pytest.raises(InputError, match=r"tait_modulus: no model of this design uses"):
        ao.sweep(KNEE, [law])
    with pytest.raises(InputError, match=r"tait_modulus: no model of this design uses"):
        ao.sweep(KNEE, [law, "rod.material=steel_42crmo4,ti_6al4v"])


def test_a_margin_far_off_has_a_place_on_the_page(tmp_path):
    """A design beyond all sense, of margins beyond single precision: no warning, a page."""
    store = tmp_path / "s.db"
    vary = ["cylinder.bore=19..26 mm:9", "rod.outer_diameter=12..20 mm:9"]
    ao.sweep(KNEE, vary, store=store, workers=1)
    assert ao.explore(store, out=tmp_path)


def _open_at(path: Path, moment: float) -> str:
    """Open a database as soon as a moment has come; what went wrong."""
    time.sleep(max(moment - time.time() - 1e-3, 0.0))
    while time.time() < moment:
        pass
    try:
        with opened(
            path, study="s", name="n", design="d", columns=[NumberColumn("x", "1")], version="0"
        ) as base:
            base.put([os.urandom(8)], StoredNumbers(np.ones((1, 1)), {}))
    except InputError as error:
        return str(error)
    return ""


def test_processes_may_begin_a_database_together(tmp_path):
    """Four at once, sixty times: none is told that the file is locked, each row stands."""
    with ProcessPoolExecutor(4) as pool:
        for number in range(60):
            path = tmp_path / f"{number}.db"
            moments = [time.time() + 0.01] * 4
            assert list(pool.map(_open_at, [path] * 4, moments)) == [""] * 4
            with sqlite3.connect(path) as connection:
                assert connection.execute("SELECT count(*) FROM rows").fetchone() == (4,)


@pytest.mark.long
def test_rows_that_stand_are_not_held(tmp_path):
    """A sweep all of whose rows stand takes the same memory at three times the size."""
    peaks = []
    for n in (8192, 24_576):
        how = {"method": "sobol", "n": n, "store": tmp_path / f"{n}.db", "workers": 1}
        ao.sweep(STEEL, WAYS[:1], **how)
        tracemalloc.start()
        assert ao.sweep(STEEL, WAYS[:1], **how).reused == n
        peaks.append(tracemalloc.get_traced_memory()[1])
        tracemalloc.stop()
    assert peaks[1] < 1.2 * peaks[0]


def test_rows_of_another_process_are_not_evaluated_again(tmp_path):
    """An empty study is not searched, but rows that another connection adds are then found."""
    about = {
        "study": "a", "name": "", "design": "", "version": "1",
        "columns": [NumberColumn("x", "m")],
    }  # fmt: skip
    keys = [bytes([k]) * 16 for k in range(4)]
    file = tmp_path / "s.db"
    with opened(file, **about) as first, opened(file, **about) as second:
        assert first.missing(keys) == ([0, 1, 2, 3], 0)
        first.put(keys[:1], StoredNumbers(np.ones((1, 1)), {}))
        second.put(keys[1:3], StoredNumbers(np.ones((2, 1)), {}))
        assert first.missing(keys) == ([3], 0)
        assert second.missing(keys) == ([3], 0)
