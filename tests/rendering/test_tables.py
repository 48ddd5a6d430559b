"""Tables of results: arrays, rows by condition and in order, CSV, frames of other packages."""

from __future__ import annotations

import csv
import itertools
import sys
import tracemalloc

import numpy as np
import pytest

import actuator_opt as ao
from actuator_opt.base.quantities import INPUTS
from actuator_opt.rendering.series import Coded
from actuator_opt.rendering.tables import DataColumn, DataTable, coded

BORE = [0.022, 0.02, np.nan, 0.03]
STEEL = ["steel", "titanium", None, "steel"]


def table():
    """A table with every kind of column; in display units its numbers are others."""
    masses = np.array([0.3, 0.2, 0.25, np.nan])
    return DataTable(
        "four",
        [
            DataColumn("bore", np.array(BORE), INPUTS["bore"]),
            DataColumn("material", coded(STEEL)),
            DataColumn("met", np.array([True, False, True, False])),
            DataColumn("number", np.arange(4)),
            DataColumn("mass", masses, INPUTS["component_mass"]),
        ],
    )


def test_columns_are_arrays_in_si():
    """Names, units, lengths, values; a row is a dict of plain values, None where missing."""
    four = table()
    assert repr(four) == "<DataTable 'four': 4 rows, 5 columns>"
    assert four.columns == ("bore", "material", "met", "number", "mass")
    assert four.units == {"bore": "m", "mass": "kg"}
    assert four["bore"].tolist()[:2] == BORE[:2]
    assert four["material"].tolist() == STEEL
    rows = list(four)
    assert len(rows) == len(four) == 4
    assert rows[2] == {
        "bore": None, "material": None, "met": True, "number": 2, "mass": 0.25
    }  # fmt: skip
    assert type(rows[0]["met"]) is bool
    assert type(rows[0]["number"]) is int
    with pytest.raises(KeyError, match='four: no column "bor"; did you mean "bore"'):
        four["bor"]


def test_rows_by_condition_and_in_order():
    """`where` keeps, `sort` orders, missing values are last in both directions, ties stay."""
    four = table()
    assert four.where(four["mass"] < 0.28)["number"].tolist() == [1, 2]
    assert four.where(met=True, material="steel")["number"].tolist() == [0]
    assert len(four.where(np.zeros(4, dtype=bool))) == 0
    assert four.sort("mass")["number"].tolist() == [1, 2, 0, 3]
    assert four.sort("mass", descending=True)["number"].tolist() == [0, 2, 1, 3]
    assert four.sort("material")["number"].tolist() == [0, 3, 1, 2]
    assert four.sort("material", "bore")["number"].tolist() == [0, 3, 1, 2]
    assert four.sort("material", "mass", descending=True)["number"].tolist() == [1, 0, 3, 2]
    for wrong in ([True], [1, 0, 1, 0], np.ones((4, 1), dtype=bool), 3):
        with pytest.raises(ao.InputError, match="where: needs 4 values"):
            four.where(wrong)
    with pytest.raises(KeyError):
        four.where(mas=1)


def test_csv_has_units_and_no_formulas(tmp_path):
    """Display units in the header, SI on demand; what a spreadsheet would run is text."""
    words = ["=HYPERLINK(1)", "+1", "-1", "@x", "\tx", 'a,"b"', None, "steel"]
    texts = DataTable("texts", [DataColumn("text", coded(words))])
    with open(texts.to_csv(tmp_path / "t.csv"), encoding="utf-8", newline="") as stream:
        cells = [row[0] if row else "" for row in csv.reader(stream)]
    assert cells == ["text", *(f"'{word}" for word in words[:5]), 'a,"b"', "", "steel"]
    head = "bore [mm],material,met,number,mass [g]\n22,steel,yes,0,300\n"
    assert table().to_csv(tmp_path / "d.csv").read_text().startswith(head)
    si = table().to_csv(tmp_path / "si.csv", units="si").read_text().splitlines()
    assert si[0] == "bore [m],material,met,number,mass [kg]"
    assert si[3] == ",,yes,2,0.25"
    with pytest.raises(ao.InputError, match="cannot write"):
        table().to_csv(tmp_path / "none" / "d.csv")
    with pytest.raises(ao.UsageError, match='units "mm": unknown'):
        table().to_csv(tmp_path / "d.csv", units="mm")


def test_the_first_rows_are_shown():
    """Twenty rows and as many columns as fit; the rest is counted; words stay words."""
    hostile = "<script>x</script>"
    many = DataTable.of("many", {f"column {k}": [hostile] * 50 for k in range(30)})
    html, text = many._repr_html_(), str(many)
    assert html.count("<tr>") == 21
    assert "30 more rows; 14 more columns" in html
    assert "<script" not in html
    assert text.splitlines()[-2:] == [
        "30 more rows",
        "25 more columns",
    ]  # 5 of 18 + 2 characters fit in 100
    assert max(map(len, text.splitlines())) <= 100
    assert "bore [mm]" in table()._repr_html_()
    assert len(str(DataTable("none", []))) == 0


def test_rows_of_different_quantities_have_their_units():
    """The column `unit` follows the numbers: SI or display units."""
    quantities = [INPUTS["bore"], INPUTS["pressure"], None]
    mixed = DataTable.of(
        "mixed", {"value": [0.02, 2e7, None], "ok": [True] * 3}, quantities=quantities,
        scaled=["value"],
    )  # fmt: skip
    assert mixed["unit"].tolist() == ["m", "Pa", None]
    assert mixed.sort("value", descending=True)["unit"].tolist() == ["Pa", "m", None]
    frame = mixed.to_frame("pyarrow", units="display")
    assert frame.column("value").to_pylist() == pytest.approx([20.0, 200.0, None])
    assert frame.column("unit").to_pylist() == ["mm", "bar", None]


READERS = {
    "pandas": lambda frame: frame.to_dict("list"),
    "polars": lambda frame: frame.to_dict(as_series=False),
    "pyarrow": lambda frame: frame.to_pydict(),
}


@pytest.mark.parametrize("library", READERS)
def test_frames(library):
    """Equal values and types in each package; missing values are missing there too."""
    pytest.importorskip(library, reason=f"{library} is not installed (extra {library})")
    for units, factor in (("si", 1.0), ("display", 1000.0)):
        frame = table().to_frame(library, units=units)
        got = READERS[library](frame)
        assert list(got) == list(table().columns)
        for name in ("bore", "mass"):
            wanted = factor * table()[name]
            values = [np.nan if x is None else x for x in got[name]]
            assert values == pytest.approx(wanted.tolist(), nan_ok=True)
        assert [x if isinstance(x, str) else None for x in got["material"]] == STEEL
        assert got["met"] == [True, False, True, False]
        assert got["number"] == [0, 1, 2, 3]
    if library == "pandas":
        assert frame.attrs["units"] == {"bore": "mm", "mass": "g"}
        assert frame["bore"].isna().sum() == 1
    elif library == "polars":
        assert frame["mass"].null_count() == frame["material"].null_count() == 1
    else:
        assert frame.schema.field("bore").metadata == {b"unit": b"mm"}


@pytest.mark.parametrize("library", ["pandas", "polars", "pyarrow", "xarray"])
def test_a_package_that_is_missing(library, monkeypatch):
    """One line, which says what to install."""
    monkeypatch.setitem(sys.modules, library, None)
    told = rf"^needs {library}; pip install 'actuator-opt\[{library}\]'$"
    calls = {"xarray": lambda: table().to_xarray({"number": 4})}
    call = calls.get(library, lambda: table().to_frame(library))
    with pytest.raises(ao.ActuatorError, match=told):
        call()
    with pytest.raises(ao.UsageError, match='library "dask": unknown'):
        table().to_frame("dask")


def test_a_grid_as_dataset():
    """Dimensions, coordinates and units of a full factorial."""
    pytest.importorskip("xarray", reason="xarray is not installed (extra xarray)")
    pairs = list(itertools.product([0.02, 0.03, 0.04], ["a", "b"]))
    values = [bore * (1 if word == "a" else 2) for bore, word in pairs]
    grid = DataTable(
        "grid",
        [
            DataColumn("bore", np.array([bore for bore, _ in pairs]), INPUTS["bore"]),
            DataColumn("word", coded([word for _, word in pairs])),
            DataColumn("mass", np.array(values), INPUTS["component_mass"]),
        ],
    )
    dataset = grid.to_xarray({"bore": 3, "word": 2}, units="display")
    assert dict(dataset.sizes) == {"bore": 3, "word": 2}
    assert float(dataset["mass"].sel(bore=30.0, word="b")) == pytest.approx(60.0)
    assert dataset["mass"].attrs == {"units": "g"}
    assert dataset["bore"].attrs == {"units": "mm"}


def test_a_million_rows_take_the_memory_of_their_numbers():
    """Frames share the arrays or copy them once; rows by condition copy what they keep."""
    pytest.importorskip("pyarrow")
    count = 1_000_000
    numbers = np.arange(4.0 * count).reshape(4, count)
    words = Coded(np.arange(count, dtype=np.int32) % 3, ("a", "b", "c"))
    million = DataTable(
        "million",
        [*(DataColumn(f"x{k}", row) for k, row in enumerate(numbers)), DataColumn("word", words)],
    )
    size = numbers.nbytes + words.codes.nbytes
    tracemalloc.start()
    million.to_frame("pyarrow")
    kept = million.where(million["x0"] >= count / 2)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert len(kept) == count // 2
    assert peak < 2 * size
