"""Sweeps and evaluations of values from a script: arrays, lists, texts; and their tables."""

from __future__ import annotations

import numpy as np
import pytest
from sweep_case import STEEL

import actuator_opt as ao

VARY = {
    "cylinder.bore": np.linspace(0.022, 0.026, 3),
    "rod.material": ["steel_42crmo4", "ti_6al4v"],
    "cylinder.stroke": "100..120 mm:2",
}


@pytest.fixture(scope="module")
def design():
    """A steel cylinder as read."""
    return ao.read(STEEL)


@pytest.fixture(scope="module")
def swept(design):
    """Twelve variants of it."""
    return ao.sweep(design, VARY, workers=1)


def test_arrays_lists_and_texts_are_one_sweep(design, swept):
    """The values of the table are those of single evaluations, numbers in SI."""
    table = swept.table()
    assert len(table) == 12
    assert table["cylinder.bore"].tolist() == np.repeat(VARY["cylinder.bore"], 4).tolist()
    assert table["rod.material"].tolist() == (["steel_42crmo4"] * 2 + ["ti_6al4v"] * 2) * 3
    assert table["cylinder.stroke"].tolist() == [0.1, 0.12] * 6
    for row in list(table)[:: len(table) - 1]:
        single = ao.evaluate(design.changed({path: row[path] for path in VARY}))
        for metric in ("mass", "stiffness_min", "burst_factor"):
            assert row[metric] == pytest.approx(float(single[metric]), rel=1e-9)
        least = min(limit.margin for limit in single.requirements)
        assert row["least_margin"] <= least + 1e-9  # checks and geometry are limits too
        assert row["met"] == (row["least_margin"] >= -1e-6)
    assert int(table["met"].sum()) == swept.feasible
    best = table.where(met=True).sort("mass")
    assert [float(x) for x in best["mass"]][:1] == [
        swept.metrics(best)["mass"] for best in swept.best
    ][:1]


def test_a_sweep_is_a_frame_and_a_dataset(swept):
    """What `table` has, in other packages; a grid has its dimensions."""
    pytest.importorskip("pyarrow", reason="pyarrow is not installed (extra pyarrow)")
    frame = swept.to_frame("pyarrow", units="display")
    assert frame.num_rows == 12
    assert frame.column("cylinder.stroke").to_pylist()[:2] == pytest.approx([100.0, 120.0])
    pytest.importorskip("xarray", reason="xarray is not installed (extra xarray)")
    dataset = swept.to_xarray()
    assert dict(dataset.sizes) == {
        "cylinder.bore": 3, "rod.material": 2, "cylinder.stroke": 2
    }  # fmt: skip
    corner = {"cylinder.bore": 0.026, "rod.material": "ti_6al4v", "cylinder.stroke": 0.12}
    assert float(dataset["mass"].sel(corner)) == swept.table()["mass"][-1]


def test_given_points_are_the_sweep(design, swept):
    """Value k of every PATH belongs to variant k; only the metrics asked for are there."""
    table = swept.table()
    columns = {path: table[path] for path in VARY}
    many = ao.evaluate_many(design, columns, metrics=("stiffness_min",), workers=1)
    assert many.columns == (
        *VARY, "mass", "stiffness_min", "met", "least_margin", "governing_limit", "failure",
    )  # fmt: skip
    for name in many.columns[3:]:
        np.testing.assert_array_equal(many[name], table[name])
    order = np.random.default_rng(3).permutation(12)
    shuffled = {path: values[order].tolist() for path, values in columns.items()}
    again = ao.evaluate_many(design, shuffled, metrics="mass", workers=1)
    np.testing.assert_allclose(again["mass"], table["mass"][order], rtol=1e-12)


def test_many_points_run_as_a_compiled_program(design):
    """A compiled program takes over for many rows, with the same numbers."""
    generator = np.random.default_rng(0)
    columns = {
        "cylinder.bore": generator.uniform(0.018, 0.021, 20_000),
        "rod.outer_diameter": generator.uniform(0.009, 0.0115, 20_000),
    }
    many = ao.evaluate_many(design, columns, metrics=("mass",), workers=1)
    places = [0, 7, 19_999]
    few = {path: values[places] for path, values in columns.items()}
    few_rows = ao.evaluate_many(design, few, metrics=("mass",), workers=1)
    for name in ("mass", "least_margin"):
        np.testing.assert_allclose(many[name][places], few_rows[name], rtol=1e-9)


@pytest.mark.parametrize(
    ("columns", "told"),
    [
        ({"cylinder.bore": np.zeros((2, 2))}, "cylinder.bore: an array of 2 dimensions"),
        ({"cylinder.bore": np.array(0.02)}, "cylinder.bore: an array of 0 dimensions"),
        ({"cylinder.bore": [[0.02]]}, "cylinder.bore: the value at index 0 is not a number"),
        ({"cylinder.bore": [0.02, np.nan]}, "cylinder.bore: the value at index 1 is nan"),
        ({"cylinder.bore": np.array([0, np.inf])}, "cylinder.bore: the value at index 1 is inf"),
        ({"cylinder.bore": [0.02, None]}, "cylinder.bore: the value at index 1 is not a number"),
        ({"cylinder.bore": [True]}, "cylinder.bore: the value at index 0 is not a number: True"),
        ({"cylinder.bore": np.array([0.02 + 1j])}, "cylinder.bore: the value at index 0 is not"),
        ({"cylinder.bore": [10**400]}, "cylinder.bore: the value at index 0 is not a number"),
        ({"cylinder.bore": [0.02, 3.0]}, "cylinder.bore: value at index 1: 3 m: "),
        ({"cylinder.bore": ["2 kg"]}, "cylinder.bore: "),
        ({"cylinder.bore": [20, "21 mm"]}, "cylinder.bore: 20 m: outside the valid range"),
        ({"cylinder.bore": ["20 mm", "21"]}, "cylinder.bore: the text at index 1 has no unit"),
        ({"seals.piston.count": [1, 1.5]}, "seals.piston.count: value at index 1: 1.5: must be a"),
        ({"cylinder.bore": []}, "cylinder.bore: has no values"),
        ({"cylinder.bore": 0.02}, "cylinder.bore: 0.02 is not a list"),
        ({"cylinder.bore": {0.02: 1}}, "cylinder.bore: {0.02: 1} is not a list"),
        ({"cylinder.bor": [0.02]}, 'cylinder.bor: unknown PATH; did you mean "cylinder.bore"?'),
        ({"name": ["x"]}, "name: is descriptive text"),
        ({3: [0.02]}, "a PATH must be a text, not 3"),
    ],
)
def test_values_that_cannot_be_varied(design, columns, told):
    """One line with PATH and index, from both functions."""
    for call in (ao.evaluate_many, ao.sweep):
        with pytest.raises(ao.InputError) as fault:
            call(design, columns)
        assert str(fault.value).startswith(told)
        assert len(str(fault.value).splitlines()) == 1


def test_numbers_among_texts_are_si(design):
    """A text never lends its unit to a number; points may repeat a value in another unit."""
    many = ao.evaluate_many(design, {"cylinder.bore": [0.02, "21 mm", "2 cm"]}, metrics=["mass"])
    np.testing.assert_allclose(many["cylinder.bore"], [0.02, 0.021, 0.02], rtol=1e-12)
    assert many["mass"][0] == many["mass"][2] < many["mass"][1]
    swept = ao.sweep(design, {"cylinder.bore": [0.02, "21 mm"]}, metrics=["mass"], workers=1)
    np.testing.assert_array_equal(swept.table()["mass"], many["mass"][:2])


def test_values_that_do_not_belong_together(design):
    """Different lengths, the same value twice in a grid, no values, unknown metrics."""
    lengths = {"cylinder.bore": [0.02, 0.03], "cylinder.stroke": [0.1]}
    with pytest.raises(ao.InputError, match=r"cylinder\.stroke: has 1 values, but cylinder\.bore"):
        ao.evaluate_many(design, lengths)
    with pytest.raises(ao.InputError, match="the value at index 2 is given twice"):
        ao.sweep(design, {"cylinder.bore": [0.02, 0.03, 0.02]})
    assert len(ao.evaluate_many(design, {"cylinder.bore": [0.02, 0.02]}, metrics=["mass"])) == 2
    for columns in ({}, ["cylinder.bore"]):
        with pytest.raises(ao.UsageError):
            ao.evaluate_many(design, columns)
    with pytest.raises(ao.UsageError, match='no metric "mas"; did you mean "mass"'):
        ao.evaluate_many(design, {"cylinder.bore": [0.02]}, metrics=["mas"])


def test_rows_that_were_not_kept(design):
    """The error says how to keep them; random points have no grid."""
    vary = {"cylinder.bore": [0.022, 0.023]}
    with pytest.raises(ao.InputError, match="not kept in memory; sweep with rows=True"):
        ao.sweep(design, vary, rows=False, workers=1).table()
    random = ao.sweep(design, ["cylinder.bore=22..23 mm"], method="lhs", n=2, workers=1)
    with pytest.raises(ao.UsageError, match="a sweep by lhs has no grid"):
        random.to_xarray()
