"""Standard sizes and glands as data."""

from __future__ import annotations

import array_api_strict as xp
import numpy as np
import pytest
from hypothesis import given, strategies as st

from actuator_opt.base.errors import InputError
from actuator_opt.base.files import data_folder
from actuator_opt.design import standard_sizes as standards, yaml_source
from actuator_opt.models.gland import groove_width

MM = 1e-3


def test_the_series_are_complete_and_say_what_was_verified():
    """27 bores from 8 to 500 mm and 35 rods from 4 to 360 mm (ISO 3320), none claimed verified."""
    bores, rods = standards.bores(), standards.rods()
    assert [len(bores), bores[0].value, bores[-1].value] == [27, 0.008, 0.5]
    assert [len(rods), rods[0].value, rods[-1].value] == [35, 0.004, 0.36]
    for sizes in (bores, rods):
        values = [size.value for size in sizes]
        assert values == sorted(set(values))
        assert {size.confidence for size in sizes} == {"secondary", "unverified"}
        assert all(size.source for size in sizes)


def test_each_table_is_that_of_the_whole_file():
    """The file, parsed as a whole, has no faults and the tables that are parsed one by one."""
    path = data_folder("materials") / "standards.yaml"
    document = yaml_source.parse(path.read_text("utf-8"), str(path))
    assert document.faults == []
    assert document.data == dict(standards.tables())


def test_a_fault_in_a_table_names_its_line(tmp_path):
    """The line is that of the file."""
    path = tmp_path / "standards.yaml"
    path.write_text("bores:\n  rows: [1]\n\nrods:\n  rows: *bores\n")
    tables = standards._Tables(path)
    assert tables["bores"] == {"rows": ["1"]}
    with pytest.raises(InputError, match=r"standards.yaml:5:9: alias"):
        tables["rods"]


def test_cylinder_pairs_have_the_published_area_ratios():
    """40/28 of ISO 6020-2 has 1.961, 140/90 of ISO 6022 has 1.704 (ordering tables)."""
    ratio = {
        (p.series, round(p.bore * 1e3), round(p.rod_diameter * 1e3)): 1
        / (1 - (p.rod_diameter / p.bore) ** 2)
        for p in standards.cylinder_pairs()
    }
    assert len(ratio) == 31
    assert ratio["ISO 6020-2", 40, 28] == pytest.approx(1.961, abs=5e-4)
    assert ratio["ISO 6020-2", 25, 12] == pytest.approx(1.299, abs=5e-4)
    assert ratio["ISO 6022", 140, 90] == pytest.approx(1.704, abs=5e-4)
    assert {p.pressure for p in standards.cylinder_pairs("ISO 6022")} == {250e5}


def test_pairs_use_standard_bores_and_rods():
    """Every pair is made of ISO 3320 sizes."""
    bores = {size.value for size in standards.bores()}
    rods = {size.value for size in standards.rods()}
    for pair in standards.cylinder_pairs():
        assert pair.bore in bores
        assert pair.rod_diameter in rods


@pytest.mark.parametrize("use", ["reciprocating", "static"])
def test_recomputed_squeeze_matches_the_published_range(use):
    """Squeeze from section and depth with tolerances is the table's own, within its rounding.

    Published per cent of the AS568 rows (minimum, maximum); they are rounded to whole numbers,
    up to 0.6 apart.
    """
    published = standards.tables()["squeeze_as568"][use]
    for gland, (low, high) in zip(standards.glands(use, "as568"), published, strict=True):
        assert 100 * gland.squeeze_min == pytest.approx(float(low), abs=0.62)
        assert 100 * gland.squeeze_max == pytest.approx(float(high), abs=0.62)


@pytest.mark.parametrize("use", ["reciprocating", "static"])
def test_glands_are_physical(use):
    """Ring fits: 5 to 35 % squeeze, wider than the ring, filled below 95 %."""
    for gland in standards.glands(use):
        assert 0.05 < gland.squeeze < 0.35
        assert gland.depth_min <= gland.depth_max < gland.section
        assert gland.section < gland.width_min <= gland.width_max
        assert np.pi / 4 * gland.section**2 < 0.95 * gland.depth * gland.width
        assert gland.source


def test_metric_glands_carry_the_published_squeeze():
    """Metric moving 3.5 mm: depth 3.1 mm, 11.4 %; static 4.0 mm: 3.15 mm, 21.3 % (guideline)."""
    assert standards.gland(3.5 * MM).squeeze == pytest.approx(0.114, abs=5e-4)
    assert standards.gland(4.0 * MM, "static").squeeze == pytest.approx(0.2125, abs=5e-4)


def test_a_gland_is_found_interpolated_or_refused():
    """3.53 mm is the AS568 section; 4.2 mm lies between; 40 mm has none."""
    assert standards.gland(3.53 * MM).table == "as568"
    between = standards.gland(4.2 * MM)
    assert between.interpolated
    # metric rows 4.0 (3.5, 4.8) and 4.5 (4.0, 5.4): 0.4 of the way
    assert between.depth == pytest.approx(3.7 * MM)
    assert between.width == pytest.approx(5.04 * MM)
    assert standards.gland(6.99 * MM, table="as568").section == pytest.approx(6.985 * MM)
    with pytest.raises(InputError, match="no reciprocating gland"):
        standards.gland(40 * MM)


def test_rings_of_series_g():
    """233 rings in five sections, tolerances 0.08 to 0.15 mm (GB/T 3452.1)."""
    rings = standards.o_rings()
    assert len(rings) == 233
    assert {ring.section for ring in rings} == {0.0018, 0.00265, 0.00355, 0.0053, 0.007}
    assert {ring.tolerance for ring in rings if ring.section == 0.00265} == {0.00009}


@pytest.mark.parametrize(
    ("kind", "value", "direction", "expected"),
    [
        ("bore", 27, "up", 32), ("bore", 27, "down", 25), ("bore", 27, "nearest", 25),
        ("bore", 25, "up", 25), ("rod", 13, "up", 14), ("rod", 19.1, "nearest", 20),
        ("section", 3.3, "nearest", 3.531), ("section", 1.8, "up", 2.616),
    ],
)  # fmt: skip
def test_nearest_standard_size(kind, value, direction, expected):
    """The next size in the asked direction, nearest by ratio."""
    assert standards.nearest_standard(kind, value * MM, direction) == pytest.approx(expected * MM)


def test_no_size_beyond_the_series():
    """Above the largest bore there is nothing to round up to."""
    with pytest.raises(InputError, match='no standard bore in direction "up"'):
        standards.nearest_standard("bore", 0.6, "up")


def test_default_groove_width_fits_the_table():
    """Within 0.09 mm of the mid-tolerance width of every AS568 reciprocating gland.

    The ratio is the least-squares one, sum(w W)/sum(W^2).
    """
    rows = standards.glands("reciprocating", "as568")
    sections = np.array([row.section for row in rows])
    widths = np.array([row.width for row in rows])
    assert np.max(np.abs(groove_width(section=sections) - widths)) < 0.09 * MM
    ratio = float(sections @ widths / (sections @ sections))
    assert groove_width(section=1.0) == pytest.approx(ratio, rel=1e-4)


@given(st.floats(1e-3, 1e-2))
def test_groove_width_laws(section):
    """Wider than the ring, floats in and floats out, complex step = slope, array = scalar."""
    width = groove_width(section=section)
    assert type(width) is float
    assert width > section
    assert groove_width(section=section + 1e-25j).imag / 1e-25 == pytest.approx(width / section)
    assert groove_width(section=np.array([section]))[0] == width


def test_groove_width_on_another_array_library_and_outside_its_domain():
    """Array-API arrays stay what they are; a section of zero has no groove."""
    found = groove_width(section=xp.asarray([2e-3, 0.0]))
    assert found.dtype == xp.float64
    assert float(found[0]) == pytest.approx(2.731e-3)
    assert bool(xp.isnan(found[1]))
