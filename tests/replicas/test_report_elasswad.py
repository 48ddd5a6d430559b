"""The [ElAsswad2018] tables on bending modulus and pressure record, and their figure."""

from __future__ import annotations

import io
import re
from math import pi, sqrt
from pathlib import Path

import numpy as np
import pytest
from report_fixture import overlaps, published_tables

from actuator_opt import api as verbs
from actuator_opt.models import barrel, stiffness, stiffness_published
from actuator_opt.pages.report import page
from actuator_opt.rendering.blocks import Drawing, Table
from actuator_opt.replicas import elasswad, elasswad_models, published
from actuator_opt.replicas.elasswad_figures import record_figure

DESIGN = Path(__file__).parents[2] / "designs" / "elasswad_knee.yaml"
OTHERS = (
    {"barrel.layup[0].thickness": "0.6 mm"},
    {"barrel.layup[0].thickness": "8 mm"},
    {"barrel.layup[0].material": "al_6061_t6"},
    {"barrel.model": "thin_laminate"},
    {"rod.material": "al_6061_t6", "cylinder.stroke": "400 mm"},
    {"fluid.material": "iso_vg_46", "seals.piston.squeeze": "10 %"},
    {"load_cases[extend].speed": "0 m/s", "load_cases[retract].speed": "0 m/s"},
)
"""Designs that the tables and the figure have to bear as well."""
INNER, OUTER, STROKE, BORE, ROD = 12.5e-3, 15e-3, 0.110, 25e-3, 12e-3
FLEXURAL = 3.48e9
LINES = 99.15e-6
"""Line volume per side behind the published oil stiffness (test_designs), m^3."""


def evaluated(**changes):
    """The shipped design, some values replaced."""
    return verbs.evaluate(verbs.read(DESIGN, set=changes) if changes else DESIGN)


@pytest.fixture(scope="module")
def evaluation():
    """The design as it is shipped."""
    return evaluated()


@pytest.fixture(scope="module")
def tables(evaluation):
    """Every table by the end of its title."""
    return {t.title.partition(": ")[2]: t for t in published_tables(evaluation)}


def cell(table, name, column=3):
    """A cell by the beginning of its row's name, spaces plain."""
    row = next(row for row in table.rows if row[0].startswith(name))
    return re.sub(r"\s", " ", row[column])


def section(bore=BORE):
    """I and A of the assumed tube, 30 mm outside."""
    return pi / 64 * ((2 * OUTER) ** 4 - bore**4), pi / 4 * ((2 * OUTER) ** 2 - bore**2)


SHEAR = 12 * section()[0] / (0.51522 * 4.55e9 * section()[1])
"""12 I/(kappa G A), kappa 0.51522 by Cowper's formula with nu 0.07 and m = 25/30, m^2/Pa."""
HERTZ = (9 / (16 * sqrt(5e-3 * OUTER) * (9e9 / 0.91) ** 2 * 500)) ** (1 / 3)
DENTS = 2 / 3 * HERTZ * (1 + 2 ** (-2 / 3))
"""Slope of Hertz's approach at 500 N, and of the mean of two supports with half of it, m/N."""


@pytest.mark.parametrize(("span", "where"), [(0.110, 0), (0.150, 1)])
def test_bending_modulus_by_hand(tables, span, where):
    """Every row equals eq. 13 with the deflection left out taken off, worked out here.

    1/E = 1/E_13 - 12 I/(kappa G A L^2) - 48 I C/L^3; caps take z^3 of the bending away.
    """
    table, (inertia, _) = tables["bending modulus"], section()
    lever = span**3 / (48 * inertia)

    def shown(name, column=3):
        return float(
            re.sub(r"(?<=\d) (?=\d)", "", cell(table, name, column)).split("; ")[where].split()[0]
        )

    shear, dents = SHEAR / span**2, DENTS / lever
    solid = 1 / (FLEXURAL / (1 - (25 / 30) ** 4))
    for name, modulus in (
        ("shear subtracted", 1 / (1 / FLEXURAL - shear)),
        ("dents at the rollers", 1 / (1 / FLEXURAL - dents)),
        ("stiff caps", FLEXURAL * (1 - 0.999 * (2 * 20e-3 / span) ** 3)),
        ("solid bar corrected", 1 / (solid - shear - dents)),
    ):
        assert shown(name) == pytest.approx(modulus / 1e9, rel=3e-3), name
    assert shown("bending modulus", 2) == pytest.approx(FLEXURAL / lever / 1e3, rel=1e-3)
    hidden = (1 / FLEXURAL - 1 / 60.8e9 - shear) * lever
    assert shown("extra compliance if") == pytest.approx(1e9 * hidden, rel=3e-3)


def test_a_solid_bar_in_eq_13_does_not_depend_on_the_span(tables):
    """3.48/(1 - (25/30)^4) = 6.721 GPa."""
    assert cell(tables["bending modulus"], "I of a solid bar") == "6.721 GPa"


def test_a_flexural_modulus_is_no_hoop_modulus(evaluation, tables):
    """Eq. 12 with 3.48 GPa grows the bore 19 times as much; the hoop modulus gives our growth back.

    By hand at 2.2 MPa: 15 mm 2.2/3480 (2.44/0.44 + 0.3) = 55.43 um. Isotropic in the plane the
    tube is a little softer than its hoop modulus of 58.25 GPa: it gives through the thickness.
    """
    table, growth = tables["bending modulus"], evaluation.metrics["bore_growth"].value
    printed = OUTER * 2.2e6 / FLEXURAL * (2.44 / 0.44 + 0.3)
    assert cell(table, "bore growth", 2).startswith(f"{1e6 * printed:.2f} µm")
    assert f"{printed / growth:.0f} times the bore growth" in table.note
    ours = re.fullmatch(r"([\d.]+) µm \(hoop modulus ([\d.]+) GPa\)", cell(table, "bore growth"))
    assert float(ours[1]) == pytest.approx(1e6 * growth, rel=1e-3)
    again = barrel.bore_growth(
        pressure=2.2e6,
        inner_radius=INNER,
        outer_radius=OUTER,
        youngs_modulus=1e9 * float(ours[2]),
        poissons_ratio=0.3,
    )
    assert again == pytest.approx(growth, rel=1e-3)
    assert 0.9 * 58.25 < float(ours[2]) < 58.25


def test_our_stiffnesses_add_up_to_the_total(evaluation, tables):
    """Oil, barrel, its stretch and rod in series are the stiffness at the weakest position."""

    def number(name, table):
        text = re.sub(r"(?<=\d) (?=\d)", "", cell(tables[table], name)).split("; ")[-1]
        return float(text.split()[0])

    parts = [
        number("oil stiffness", "oil stiffness"),
        number("barrel stiffness", "barrel"),
        number("stretch of the barrel", "barrel"),
        number("rod stiffness", "rod stiffness"),
    ]
    total = 1 / sum(1 / part for part in parts)
    assert total == pytest.approx(number("total stiffness", "barrel"), rel=2e-3)


def test_the_record_gives_the_published_friction(evaluation):
    """Eq. 15 to 20 along it: 166 N on average, 400 N at most; b = sqrt(2^2 - 1.7^2) mm.

    It starts, turns and ends without pressure, and the piston nowhere exceeds the cases' speed.
    """
    record = elasswad_models.own_record(evaluation)
    width = sqrt(2.0**2 - 1.7**2) * 1e-3
    force = 0.61 * record.pressure * width * pi * (BORE + ROD)
    assert np.mean(force[:-1]) == pytest.approx(166.0, rel=1e-9)
    assert np.max(force) == pytest.approx(400.0, rel=1e-9)
    turn = record.time.size // 2
    assert record.pressure[[0, turn, -1]] == pytest.approx(0.0, abs=1e-6)
    assert record.place[[0, turn, -1]] == pytest.approx([0.0, 1.0, 0.0], abs=1e-12)
    assert np.all(record.pressure >= 0)
    speed = np.gradient(STROKE * record.place, record.time)
    assert np.max(np.abs(speed)) == pytest.approx(0.1, rel=1e-3)


def test_along_the_record_by_hand(evaluation):
    """At every time: eq. 7 and 10 to 12; both chambers pushed by hand; the design's own curve.

    A force moves the piston by y: p_A = -A_A y/C_A, p_B = A_B y/C_B.
    """
    record = elasswad_models.own_record(evaluation)
    found = elasswad_models.along(evaluation, record)
    ratio = OUTER / INNER
    lame = (ratio**2 + 1) / (ratio**2 - 1) + 0.3
    inner = INNER * record.pressure / FLEXURAL * lame
    np.testing.assert_allclose(found.growth_inner, inner, rtol=1e-12)
    np.testing.assert_allclose(found.growth_published, ratio * inner, rtol=1e-12)
    loaded = record.pressure > 1.0
    area = pi / 4 * (BORE + 2 * ratio * inner[loaded]) ** 2
    soft = 1 / 2480e3 + 1 / 13430e3 + STROKE / (record.pressure[loaded] * area)
    np.testing.assert_allclose(found.stiffness_published[loaded], 1 / soft, rtol=1e-12)
    per_pressure = 2 * pi * INNER**2 * lame / FLEXURAL
    force = 0.0
    for side, length in (
        (pi / 4 * BORE**2, STROKE * record.place),
        (pi / 4 * (BORE**2 - ROD**2), STROKE * (1 - record.place)),
    ):
        taken = (side * length + LINES) / 800e6 + per_pressure * length
        force = force + side * side / taken
    np.testing.assert_allclose(found.stiffness_chambers, 1 / (1 / force + 1 / 13430e3), rtol=1e-4)
    growth = evaluation.metrics["bore_growth"].value / 2.2e6
    np.testing.assert_allclose(found.growth_designed, growth * record.pressure, rtol=1e-12)
    curve = evaluation.curve
    assert found.stiffness_designed[0] == pytest.approx(curve.stiffness[0], rel=1e-12)
    middle = np.argmin(np.abs(record.place - 0.5))
    assert found.stiffness_designed[middle] == pytest.approx(curve.stiffness[50], rel=1e-3)


def test_a_record_in_a_script():
    """A measured record, published and derived, by plain calls on its columns.

    The published stiffness is zero where the pressure is and two hundred times too soft at its
    peak; the derived one is the same at every pressure.
    """
    file = io.StringIO("t,p\n0.0,0.0\n0.1,2.0e6\n0.2,5.0e6\n0.3,2.0e6\n")
    _, pressure = np.loadtxt(file, delimiter=",", skiprows=1, unpack=True)
    wall = {"youngs_modulus": 58.25e9, "poissons_ratio": 0.3}
    k, growth = stiffness_published.equivalent_stiffness_as_published(
        pressure=pressure,
        bore=BORE,
        outer_diameter=2 * OUTER,
        stroke=STROKE,
        oil=2480e3,
        rod=13430e3,
        **wall,
    )
    radii = {"inner_radius": INNER, "outer_radius": OUTER}
    expansion = barrel.bore_growth(pressure=pressure, **radii, **wall)
    unit = barrel.bore_growth(pressure=1.0, **radii, **wall)
    give = barrel.chamber_compliance(
        inner_radius=INNER, growth_per_pressure=unit, length=STROKE / 2
    )
    areas = {"area_a": 4.9087e-4, "area_b": 3.7777e-4}
    chambers = {
        f"compliance_{side}": stiffness.chamber_compliance(
            volume=areas[f"area_{side}"] * STROKE / 2 + 3e-6,
            bulk_modulus=800e6 + 0 * pressure,
            wall_compliance=give,
        )
        for side in "ab"
    }
    derived = stiffness.series(stiffness.hydraulic_stiffness(**areas, **chambers), 13430e3)
    assert k.shape == growth.shape == expansion.shape == derived.shape == (4,)
    assert k[0] == growth[0] == 0.0
    assert np.ptp(derived) == 0.0
    assert derived[2] / k[2] > 200
    np.testing.assert_allclose(growth, 1.2 * expansion, rtol=1e-12)


@pytest.mark.parametrize("changes", [{}, *OTHERS], ids=lambda c: " ".join(c) or "as shipped")
def test_tables_and_figure_bear_any_design(changes):
    """Whatever the design: every table is made, no label overlaps or leaves the drawing."""
    one = evaluated(**changes)
    found = published_tables(one)
    assert len(found) == len(elasswad.TABLES)
    assert all(table.rows and table.note for table in found)
    record = elasswad_models.own_record(one)
    ink = record_figure(record, elasswad_models.along(one, record))
    boxes = ink.text_boxes()
    assert overlaps(boxes) == []
    for words, left, top, right, bottom in boxes:
        assert 0 <= left < right <= ink.width, words
        assert 0 <= top < bottom <= ink.height, words


def test_the_figure_stands_after_its_table(evaluation):
    """On the page the drawing follows the table of the record, and says whose record it is."""
    blocks = page(evaluation, extra_tables=published(evaluation)).blocks
    at = next(i for i, b in enumerate(blocks) if b.title.endswith("pressure record"))
    assert isinstance(blocks[at], Table)
    assert isinstance(blocks[at + 1], Drawing)
    assert "record of our own" in blocks[at + 1].note


def test_every_curve_is_labelled_in_its_own_ink(evaluation):
    """Each of the nine curves has its label beside the frame, in its colour, with its value."""
    record = elasswad_models.own_record(evaluation)
    ink = record_figure(record, elasswad_models.along(evaluation, record))
    curves = [m for m in ink.marks if "path" in m and max(map(len, m["path"])) > 200]
    named = [m for m in ink.marks if "text" in m and re.search(r"\d (MPa|µm|k?N/mm)$", m["text"])]
    assert len(curves) == len(named) == 9
    assert sorted(m["stroke"] for m in curves) == sorted(m["color"] for m in named)
    assert len({(m["stroke"], tuple(m["dash"])) for m in curves}) == 4
