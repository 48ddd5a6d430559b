"""The [Huang2017] pages of its design's report: tables, figures, verdicts, trace of equations."""

from __future__ import annotations

import importlib
import itertools
import re
from dataclasses import dataclass
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from report_fixture import overlaps

from actuator_opt import api as verbs
from actuator_opt.evaluation import film
from actuator_opt.pages.report import page
from actuator_opt.rendering.blocks import Drawing, Table
from actuator_opt.replicas import MODULES, huang, huang_figures, huang_models, huang_notes

pytestmark = pytest.mark.long


DESIGN = Path(__file__).parents[2] / "designs" / "huang_110_80_560.yaml"
UNDRAWN = ("why damping rises or falls with pressure", "functions for its equations")
"""Tables without a drawing."""
LONG = {"seals.rod.relief": "4.8 mm", "seals.rod.land": "1 mm"}
OTHERS = (
    LONG
    | {"cylinder.bore": "125 mm", "fluid.material": "iso_vg_32", "fluid.temperature": "60 degC"},
    pytest.param(
        {
            "seals.rod.relief": "0.5 mm",
            "seals.rod.secondary.squeeze": "5 %",
            "cylinder.stroke": "1 m",
        },
        marks=pytest.mark.long,  # its verdicts are those of the shipped design
    ),
)
"""Designs that the tables and figures have to bear as well."""


@dataclass(frozen=True)
class Pages:
    """A design with its tables by the end of their title, all blocks, and the drawings."""

    subject: object
    tables: dict
    blocks: list
    figures: list


def pages(subject):
    """All tables, then all drawings, of one study with films of 61 nodes instead of 121."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(film, "NODES", 61)
        found = huang_models.study_of(subject.design)
        patch.setattr(huang, "study_of", lambda design: found)
        made = huang.blocks(subject)
    drawn = (
        huang_figures.cylinder_figure(found),
        huang_figures.plunger_figure(found),
        huang_figures.speed_figure(found),
        huang_figures.simulated_figure(found),
        huang_figures.ring_figure(found),
        huang_figures.back_up_figure(found),
        huang_figures.relief_figure(found),
    )
    tables = {t.title.partition(": ")[2]: t for t in made if isinstance(t, Table)}
    return Pages(subject, tables, made, [ink for ink in drawn if ink is not None])


def plain(words):
    """Spaces plain."""
    return re.sub(r"\s", " ", words)


@pytest.fixture(scope="module")
def shipped():
    """The design as it is shipped, evaluated."""
    return pages(verbs.evaluate(DESIGN))


@pytest.fixture(scope="module")
def tables(shipped):
    """Its tables."""
    return shipped.tables


@pytest.fixture(scope="module", params=OTHERS, ids=lambda c: next(iter(c)))
def other(request):
    """Another design: the pages read nothing else of an evaluation."""
    return pages(SimpleNamespace(design=verbs.read(DESIGN, set=request.param).design))


def verdict(table, claim):
    """The last cell of the row whose claim begins so."""
    return next(row for row in table.rows if row[0].startswith(claim))[-1]


@pytest.mark.parametrize(
    "number",
    ["0.65 to 0.2 MN·s/m", "9.17 mm/s, 7.15 MPa", "41.72", "1.4×10⁻²⁶", "0.732", "0.177",
     "only from 2.07 to 2.15 mm/s", "0.1 and 0.25"],
)  # fmt: skip
def test_published_numbers_stand_in_the_tables(tables, number):
    """What the paper prints, or table 2 gives, is set beside ours."""
    cells = [str(cell) for table in tables.values() for row in table.rows for cell in row]
    assert number in plain("\n".join([*cells, *(t.note for t in tables.values())]))


@pytest.mark.parametrize(
    ("table", "claim", "expected"),
    [
        ("piston cylinder, test A", "B falls", "agrees"),
        ("piston cylinder, test A", "B rises", "agrees"),
        ("piston cylinder, test A", "B is larger", "agrees"),
        ("its simulation and ours", "B falls with speed", "agrees"),
        ("its simulation and ours", "B falls from 0.65", "disagrees"),
        ("its simulation and ours", "simulated B", "disagrees"),
        ("its simulation and ours", "B falls drastically", "disagrees"),
        ("its simulation and ours", "at high speed B tends", "disagrees"),
        ("its simulation and ours", "the pressure between", "agrees"),
        ("step ring at rest and running", "the largest", "agrees"),
        ("step ring at rest and running", "beyond 5 MPa", "agrees in part"),
        ("step ring at rest and running", "the contact grows", "agrees"),
        ("step ring at rest and running", "the mean film", "disagrees"),
    ],
)
def test_verdicts(tables, table, claim, expected):
    """Each claim by the numbers that test_huang pins: no trend is made to fit."""
    assert verdict(tables[table], claim) == expected


def test_the_pages_say_what_is_proven_and_what_is_not(tables):
    """The doubt about the measured fall, and that seal types could but need not explain it."""
    plunger = plain(tables["plunger, test B"].note)
    assert "our model does not reproduce the measured trend" in plunger
    assert re.search(r"error of 1\.\d % to 1\.8 % in the change of the pressure force", plunger)
    assert "We do not know whether the measured or the computed trend is right" in plunger
    kinds = plain(tables["why damping rises or falls with pressure"].note)
    assert "It does not show that they did so in the tests" in kinds
    assert "We chose relief, land, squeeze" in kinds
    relief = plain(tables["relief of the step ring"].note)
    assert re.search(
        r"rising to falling at a relief of 4\.3\d mm, 74 % of the ring's width", relief
    )
    assert "no relief shown reverses the trend" in relief
    parts = plain(tables["plunger part by part"].note)
    assert "can be neglected, as the paper says" in parts
    assert "h_v = 0.23 mm" in parts
    fits = plain(tables["fits over speed"].note)
    assert "Every exponent is below 0" in fits


@pytest.mark.long
def test_another_seal_turns_the_verdicts(other):
    """A relief beyond the turning one: the step ring's B falls and its film grows; a short one not.

    With a relief of 4.8 and a land of 1 mm k is below 1/2, with 0.5 mm above 2.
    """
    ring, tables = other.subject.design.seals.rod, other.tables
    kinds = {row[0]: row for row in tables["why damping rises or falls with pressure"].rows}
    _, balance, *_, rise = kinds["step ring, plunger, alone"]
    film_grows = verdict(tables["step ring at rest and running"], "the mean film")
    if ring.relief > 4e-3:
        assert float(balance) < 0.5
        assert float(rise) < 1
        assert film_grows == "agrees"
        assert "this design a 125/80-560" in plain(tables["piston cylinder, test A"].note)
    else:
        assert float(balance) > 2
        assert float(rise) > 2
        assert film_grows == "disagrees"


def check(made):
    """Every table is made, no cell is NaN, no label overlaps or leaves the drawing."""
    assert len(made.tables) == len(huang.TABLES)
    assert all(table.rows and table.note for table in made.tables.values())
    for table in made.tables.values():
        assert {len(row) for row in table.rows} == {len(table.columns)}
        for words in (table.note, *(str(cell) for row in table.rows for cell in row)):
            assert not re.search(r"\bnan\b", words), words
    assert len(made.figures) == 7
    for ink in made.figures:
        boxes = ink.text_boxes()
        assert overlaps(boxes) == []
        for words, left, top, right, bottom in boxes:
            assert 0 <= left < right <= ink.width, words
            assert 0 <= top < bottom <= ink.height, words
        for mark in ink.marks:
            for x, y in itertools.chain(*mark.get("path", ())):
                assert 0 <= x <= ink.width
                assert 0 <= y <= ink.height


def test_tables_and_figures_as_shipped(shipped):
    """The shipped design."""
    check(shipped)


def test_tables_and_figures_bear_other_designs(other):
    """Other seals, oil and bore."""
    check(other)


def test_the_design_gets_these_pages():
    """Tables are looked up by what the design reproduces."""
    assert MODULES["Huang2017"] == huang.__name__.rpartition(".")[2]
    assert verbs.read(DESIGN).design.reproduces == "Huang2017"


def test_contours_lie_where_the_surface_has_the_level():
    """B = p/v on a grid: the pieces of the level 2 lie on p = 2 v, within the grid's width."""
    speeds, pressures = np.geomspace(0.5, 10, 40), np.linspace(1, 10, 40)
    values = pressures[:, None] / speeds
    pieces = huang_figures.segments(np.log10(speeds), pressures, np.log(values), np.log(2.0))
    assert pieces
    for x, y in itertools.chain(*pieces):
        assert y == pytest.approx(2 * 10**x, rel=1e-2)  # the level is linear in ln B between nodes
    length = sum(abs(b[1] - a[1]) for a, b in pieces)
    assert length == pytest.approx(9.0, rel=0.02)  # from 0.5 mm/s, 1 MPa to 5 mm/s, 10 MPa


def test_every_equation_is_traced_once():
    """1 to 31, each in one row: to functions, or out of scope with the reason."""
    numbers = [n for t in huang.TRACES for n in range(t.first, t.last + 1)]
    assert numbers == list(range(1, 32))
    for trace in huang.TRACES:
        assert trace.functions or trace.remark.startswith("out of scope: "), trace.subject


@pytest.mark.parametrize("name", sorted({name for t in huang.TRACES for name in t.functions}))
def test_every_traced_function_exists(name):
    """Each is a public function or class of the package."""
    module, _, function = name.rpartition(".")
    assert callable(getattr(importlib.import_module(f"actuator_opt.{module}"), function))


def test_misprints_stand_in_the_trace(tables):
    """Eq. 2 and its minus, a and b in eq. 4, eq. 14 and 15 without shift, q and g in eq. 19."""
    rows = {row[0]: row[3] for row in tables["functions for its equations"].rows}
    assert "minus" in rows["2"]
    assert "u_a = U is the speed of the rod" in rows["4"]
    assert "rigid shift" in rows["11–15"]
    assert "density and viscosity" in rows["19–22"]
    note = plain(tables["functions for its equations"].note)
    assert "so no film meets eq. 12" in note


@pytest.mark.parametrize(
    ("share", "words"),
    [(1.0, "agrees"), (0.0, "disagrees"), (0.5, "agrees in part"), (float("nan"), "no film")],
)
def test_words_of_a_verdict(share, words):
    """By the share of a claim that holds."""
    assert huang_notes.verdict(share) == words


def test_figures_stand_after_their_tables(shipped, tables):
    """On the page each drawing follows its table; the equations stand last."""
    blocks = page(shipped.subject, extra_tables=shipped.blocks).blocks
    titles = [block.title for block in blocks]
    drawn = [name for name in tables if name not in UNDRAWN]
    for name in drawn:
        at = titles.index(f"Huang 2017: {name}")
        assert (type(blocks[at]), type(blocks[at + 1])) == (Table, Drawing)
    assert len(drawn) == len(shipped.figures)
    assert titles[titles.index("Huang 2017: functions for its equations") + 1] == "Appendix"
