"""A sweep as Parquet: the values of the CSV, typed, with what they are; written in flat memory."""

from __future__ import annotations

import csv
import json
import subprocess
import sys
import tracemalloc

import numpy as np
import pytest
from cases.digests import digest
from cli_runner import run as terminal
from sweep_case import KNEE, NEAR, STEEL, WAYS

import actuator_opt as ao
from actuator_opt.base.database import StoredNumbers
from actuator_opt.base.errors import ActuatorError, InputError, UsageError
from actuator_opt.pages.sweep import SweepColumns, about
from actuator_opt.rendering import series as parquet_file
from actuator_opt.rendering.series import ParquetFile
from actuator_opt.sweeps import run
from actuator_opt.sweeps.chunk import Chunk

arrow = pytest.importorskip("pyarrow")
parquet = pytest.importorskip("pyarrow.parquet")

MIXED = [  # some threads are larger than the rod, which fails
    "rod.thread.diameter=8..12 mm", "cylinder.bore=20.9..21.1 mm",
    "rod.material=steel_42crmo4,ti_6al4v", "fluid.material=iso_vg_32,iso_vg_46",
]  # fmt: skip


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    """The same rows as CSV and as Parquet, in several row groups, with failures and texts."""
    folder = tmp_path_factory.mktemp("rows")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(run, "CHUNK", 64)
        patch.setattr(parquet_file, "GROUP", 100)
        swept = ao.sweep(
            ao.read(KNEE, set=NEAR), MIXED, method="lhs", n=300, seed=3, workers=1,
            csv=folder / "r.csv", parquet=folder / "r.parquet",
        )  # fmt: skip
    return swept, folder / "r.csv", folder / "r.parquet"


@pytest.mark.long
def test_every_cell_is_that_of_the_csv(files):
    """Numbers to the nine digits of the CSV, blanks as null, texts and verdicts as they are."""
    swept, text, binary = files
    with text.open(encoding="utf-8") as stream:
        expected = list(csv.DictReader(stream))
    found = parquet.read_table(binary)
    assert parquet.ParquetFile(binary).num_row_groups == 3
    assert found.column_names == list(expected[0])
    assert found.num_rows == len(expected) == 300
    assert 0 < swept.failed < 300
    for head in found.column_names:
        cells = [row[head] for row in expected]
        values = found[head].to_pylist()
        if head == "feasible":
            told = ["" if one is None else "yes" if one else "no" for one in values]
        elif arrow.types.is_floating(found.schema.field(head).type):
            told = ["" if one is None else f"{one:.9g}" for one in values]
        else:
            told = ["" if one is None else str(one) for one in values]
        assert told == cells, head


def test_numbers_are_the_rows_to_the_last_bit(tmp_path):
    """No digit is lost: the mass in g is that of the best designs, exactly."""
    near = ao.read(KNEE, set=NEAR)
    swept = ao.sweep(near, WAYS, method="lhs", n=100, parquet=tmp_path / "rows.parquet")
    found = parquet.read_table(tmp_path / "rows.parquet")["mass [g]"]
    assert swept.best
    for best in swept.best:
        mass = swept.metrics(best)["mass"]
        assert found[best.number].as_py() == swept.study.quantity("mass").to_display(mass)
        values = {path: str(value) for path, value in swept.study.values(best.number).items()}
        alone = ao.evaluate(ao.read(KNEE, set=NEAR | values)).metrics["mass"].value
        assert found[best.number].as_py() == pytest.approx(1000 * alone, rel=1e-12)


def test_columns_say_what_they_are(files):
    """Types; PATH or metric, label and unit of every field; what the rows rest on."""
    swept, _, binary = files
    schema = parquet.read_schema(binary)
    kinds = {field.name: field.type for field in schema}
    text = arrow.dictionary(arrow.int32(), arrow.string())
    texts = {"rod.material", "fluid.material", "governing_limit", "failure"}
    assert {name for name, kind in kinds.items() if kind == text} == texts
    assert kinds["number"] == arrow.int64()
    assert kinds["feasible"] == arrow.bool_()
    assert all(
        kinds[name] == arrow.float64() for name in kinds.keys() - texts - {"number", "feasible"}
    )
    for name in swept.study.metrics:
        quantity = swept.study.quantity(name)
        head = f"{name} [{quantity.unit}]" if quantity.unit else name
        told = {key.decode(): value.decode() for key, value in schema.field(head).metadata.items()}
        told.pop("PARQUET:field_id", None)
        assert told == {"name": name, "unit": quantity.unit or "1", "label": quantity.label}
    told = {key.decode(): value.decode() for key, value in schema.metadata.items()}
    told = {key.split(".")[1]: value for key, value in told.items() if "actuator_opt." in key}
    base = ao.evaluate(KNEE).to_dict()
    assert told["version"] == base["version"]
    assert told["study"] == swept.study.hash
    plan = json.loads(told["plan"])
    assert (plan["method"], plan["count"], plan["seed"]) == ("lhs", 300, 3)
    assert plan["vary"]["cylinder.bore"] == {"from": 0.0209, "to": 0.0211, "steps": None}
    assert plan["vary"]["rod.material"] == ["steel_42crmo4", "ti_6al4v"]
    again = ao.read(told["design"])
    assert again.design == swept.study.design
    assert ao.evaluate(again).to_dict()["spec_hash"] == told["spec_hash"]


def test_same_rows_same_bytes(tmp_path, monkeypatch):
    """Computed in one process or two, or taken from a store."""
    monkeypatch.setattr(run, "CHUNK", 64)
    names = [tmp_path / f"{k}.parquet" for k in range(3)]
    how = {"method": "sobol", "n": 300}
    ao.sweep(STEEL, WAYS[:1], parquet=names[0], workers=1, store=tmp_path / "s.db", **how)
    ao.sweep(STEEL, WAYS[:1], parquet=names[1], workers=2, **how)
    ao.sweep(STEEL, WAYS[:1], parquet=names[2], workers=1, store=tmp_path / "s.db", **how)
    assert len({name.read_bytes() for name in names}) == 1


@pytest.mark.long
def test_memory_does_not_grow_with_the_rows(tmp_path):
    """Twice as many rows, 200 000 of them, take no more memory at their worst."""
    swept = ao.sweep(ao.read(KNEE, set=NEAR), WAYS, method="lhs", n=8)
    study = swept.study
    rows = np.tile(swept.sample.feasible.rows[:1], (4096, 1))
    rows[:, 0] = np.linspace(0.02, 0.021, 4096)
    peaks = []
    for count in (25, 49):
        held = 0
        tracemalloc.start()
        columns = SweepColumns(study)
        with ParquetFile(columns.fields, about(study), tmp_path / "many.parquet") as table:
            for k in range(count):
                given = StoredNumbers(rows, {})
                chunk = Chunk(4096 * k, given, 4096, rows[:, 0], rows[:, -1] == 1.0)
                table.add(columns.values(chunk))
                held = max(held, arrow.total_allocated_bytes())
        peaks.append(tracemalloc.get_traced_memory()[1] + held)
        tracemalloc.stop()
    assert parquet.read_metadata(tmp_path / "many.parquet").num_rows == 200_704
    assert peaks[1] < 1.05 * peaks[0]


def test_without_the_extra_one_line_says_how_to_have_it(tmp_path, monkeypatch):
    """Before the work, and nothing is written."""
    monkeypatch.setitem(sys.modules, "pyarrow", None)
    monkeypatch.setattr("actuator_opt.sweeps.run._computed", None)
    with pytest.raises(ActuatorError) as fault:
        ao.sweep(KNEE, WAYS, method="lhs", n=4, csv=tmp_path / "r.csv", parquet=tmp_path / "r.pq")
    assert str(fault.value) == "Parquet files need pyarrow; pip install 'actuator-opt[parquet]'"
    assert not list(tmp_path.iterdir())


LIMITED = """
import resource, signal, sys
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
resource.setrlimit(resource.RLIMIT_FSIZE, (300_000, 300_000))
import actuator_opt as ao
from actuator_opt.base.errors import InputError
from actuator_opt.rendering import series
series.GROUP = int(sys.argv[4])
vary = ["cylinder.bore=18..26 mm", "rod.outer_diameter=9..13 mm"]
try:
    ao.sweep(
        sys.argv[1], vary, method="lhs", n=6000, workers=1,
        parquet=sys.argv[2], csv=sys.argv[3] or None,
    )
except InputError as error:
    print(error)
"""


@pytest.mark.long
@pytest.mark.parametrize("group", ["1000", "100000"])
@pytest.mark.parametrize("table", ["", "rows.csv"])
def test_a_full_disk_leaves_what_stood(tmp_path, group, table):
    """In the midst or at the end: one line, of the file that it is; the old one is whole."""
    old = tmp_path / "rows.parquet"
    old.write_text("old")
    files = [str(old), str(tmp_path / table) if table else ""]
    end = subprocess.run(
        [sys.executable, "-c", LIMITED, STEEL, *files, group], capture_output=True, text=True
    )
    assert end.returncode == 0, end.stderr
    assert end.stderr == ""
    assert f"{table or 'rows.parquet'}: cannot write: File too large" in end.stdout
    assert len(end.stdout.splitlines()) == 1
    assert old.read_text() == "old"
    assert [path.name for path in tmp_path.iterdir()] == ["rows.parquet"]


def test_places_that_cannot_be(tmp_path):
    """No folder, a folder in the way, a place to read alone: one line before the work."""
    (tmp_path / "folder").mkdir()
    for place in (tmp_path / "no" / "r.parquet", tmp_path / "folder", "/proc/r.parquet"):
        with pytest.raises(InputError) as fault:
            ao.sweep(STEEL, WAYS[:1], method="lhs", n=4, parquet=place)
        assert len(fault.value.diagnostics) == 1
        assert str(place) in str(fault.value)


def test_one_file_for_two_things_is_refused(tmp_path):
    """A table in place of the store would lose its rows."""
    store = tmp_path / "rows.db"
    ao.sweep(STEEL, ["cylinder.bore=18..26 mm:3"], store=store)
    before = digest(store)
    for name in ("csv", "parquet"):
        with pytest.raises(UsageError, match="two of --store"):
            ao.sweep(STEEL, ["cylinder.bore=18..26 mm:3"], store=store, **{name: str(store)})
    assert digest(store) == before


def test_the_terminal_names_the_file(tmp_path):
    """The option, its line, and what it does not go with."""
    file = tmp_path / "rows.parquet"
    words = ["sweep", STEEL, "--vary", "cylinder.bore=30..34 mm:3"]
    done = terminal(*words, "--parquet", str(file))
    assert f"wrote {file}" in done.err
    assert parquet.read_metadata(file).num_rows == 3
    done = terminal(*words, "--parquet", str(file), "--reduce", "best:3")
    assert done.code == 2
    assert "omit --store, --csv and --parquet" in done.err
