"""The section drawing: true scale, complete, labels apart."""

import itertools
import math
from dataclasses import replace

import pytest
import report_fixture as fixture
from hypothesis import given, settings, strategies as st
from report_fixture import overlaps

from actuator_opt.evaluation.result import Outline
from actuator_opt.pages import section as drawing, stiffness as stiffness_page
from actuator_opt.pages.section import SCALES, choose_scale, section
from actuator_opt.rendering import axes as figures, chart_ink, ink
from actuator_opt.rendering.blocks import Chart


def span(marks, pick):
    """Least and largest x of the path marks that `pick` accepts."""
    xs = [x for m in marks if "path" in m and pick(m) for line in m["path"] for x, _ in line]
    return min(xs), max(xs)


def is_oil(mark):
    """Whether a mark is the oil's tint."""
    return mark["fill"] == "#dcecf7"


def test_110_mm_at_1_to_2_are_55_mm_on_paper():
    """The oil column of the knee is 110 mm long: 55 mm on the sheet at 1:2."""
    drawn = section(fixture.build_evaluation())
    left, right = span(drawn.ink.marks, is_oil)
    assert drawn.scale == "1:2"
    assert right - left == pytest.approx(55.0, abs=0.002)


@pytest.mark.parametrize(
    ("bore", "scale", "stroke"), [(3e-3, "5:1", 13.2), (25e-3, "1:2", 110.0), (0.5, "1:50", 2200.0)]
)
def test_scale_follows_size(bore, scale, stroke):
    """Tiny and huge actuators get the ISO scale that fits, and keep to it."""
    drawn = section(fixture.scaled(bore))
    left, right = span(drawn.ink.marks, is_oil)
    paper, real = map(int, scale.split(":"))
    assert drawn.scale == scale
    assert right - left == pytest.approx(stroke * paper / real, abs=0.003)


def test_scales_are_those_of_iso_5455():
    """1, 2, 5 steps only, enlargements up to 50:1, in falling order, none twice."""
    factors = [paper / real for paper, real in SCALES]
    assert factors == sorted(set(factors), reverse=True)
    assert {str(max(pair))[0] for pair in SCALES} == {"1", "2", "5"}
    assert (1, 1) in SCALES
    assert SCALES[0] == (50, 1)


@given(st.floats(1e-3, 20.0), st.floats(1e-4, 1.0))
def test_the_chosen_scale_is_the_largest_that_fits(length, height):
    """The drawing fits its room, and the next larger ISO scale would not."""
    paper, real = choose_scale(length, height, 166.0, 78.0)
    factor = 1000 * paper / real
    fits = [s for s in SCALES if max(length / 166.0, height / 78.0) * 1000 * s[0] / s[1] <= 1]
    assert (paper, real) == fits[0]
    assert length * factor <= 166.0


@settings(max_examples=40, deadline=None)
@given(
    bore=st.floats(4e-3, 0.4),
    slender=st.floats(0.2, 20.0),
    rod=st.floats(0.3, 0.8),
    layers=st.integers(1, 24),
)
def test_labels_never_collide_and_stay_on_the_sheet(bore, slender, rod, layers):
    """Whatever the proportions: no two texts overlap and none leaves the drawing."""
    unit = bore / 25
    parts, lengths = fixture.outlines(
        bore, slender * bore, rod * bore, rod * bore / 2, (0.02 * bore,) * layers, unit
    )
    drawn = section(fixture.build_evaluation(outlines=parts, lengths=lengths))
    boxes = drawn.ink.text_boxes()
    assert overlaps(boxes) == []
    for _, left, top, right, bottom in boxes:
        assert left >= -0.1
        assert right <= drawn.ink.width + 0.1
        assert top >= -0.1
        assert bottom <= drawn.ink.height + 0.1


def test_every_part_has_its_number():
    """Each outline gets one balloon and one line of the parts list."""
    evaluation = fixture.build_evaluation()
    drawn = section(evaluation)
    numbers = {m["text"] for m in drawn.ink.marks if "text" in m and m["text"].isdigit()}
    assert numbers == {str(item.number) for item in drawn.items}
    assert [i.part for i in drawn.items] == [o.part for o in evaluation.outlines]


def test_dimensions_say_the_lengths():
    """Bore, rod, barrel, stroke and closed length are written in mm."""
    words = {m["text"] for m in section(fixture.build_evaluation()).ink.marks if "text" in m}
    wanted = {"⌀25 bore", "⌀12 rod", "⌀28.8 barrel", "stroke 110", "closed length 204"}
    assert wanted <= words


def test_no_outlines_is_said():
    """An evaluation without outlines gives a sentence instead of a drawing."""
    drawn = section(fixture.build_evaluation(outlines=()))
    assert "not drawn" in drawn.ink.marks[0]["text"]


def test_a_part_in_two_pieces_shows_no_seam():
    """The shared edge of two polygons of one part is not drawn."""
    halves = (fixture.ring(0, 0.01, 0, 0.02), fixture.ring(0.01, 0.03, 0.01, 0.02))
    part = Outline("cap", "steel", halves, "metal")
    edges = drawing._edges(part, drawing._Frame(1000.0, 0.0, 0.0, 0.0))
    seam = [
        (a, b)
        for line in edges
        for a, b in itertools.pairwise(line)
        if a[0] == b[0] == 10.0 and min(abs(a[1]), abs(b[1])) >= 10.0 - 1e-9
    ]
    assert seam == []
    assert any(a[0] == b[0] == 10.0 for line in edges for a, b in itertools.pairwise(line))


def test_hatch_covers_the_area_at_its_spacing():
    """Total hatch length × spacing is the area (a line stands for one strip), holes left out."""
    outer = ((0.0, 0.0), (40.0, 0.0), (40.0, 30.0), (0.0, 30.0))
    hole = ((10.0, 10.0), (20.0, 10.0), (20.0, 20.0), (10.0, 20.0))
    for angle in (0.0, 30.0, 45.0, 135.0):
        lines = ink.hatch([outer, hole], angle=angle, spacing=0.05)
        total = sum(math.dist(a, b) for a, b in lines)
        assert total * 0.05 == pytest.approx(1100.0, rel=2e-3)


@given(st.lists(st.floats(0, 100), min_size=1, max_size=20), st.floats(0.5, 4.0))
def test_spread_keeps_order_and_gaps(wanted, gap):
    """Spread labels keep their order and gaps, and none moves when all are free."""
    wanted = sorted(wanted)
    places = ink.spread(wanted, [gap] * (len(wanted) - 1))
    assert all(b - a >= gap - 1e-9 for a, b in itertools.pairwise(places))
    if all(b - a >= gap for a, b in itertools.pairwise(wanted)):
        assert places == pytest.approx(wanted)


def stiffness_ink(curve, requirement):
    """The stiffness figure of a report."""
    panels = stiffness_page.stiffness_panels(curve, requirement)
    return chart_ink.drawn(Chart("Stiffness", panels, height=62.0))


def test_stiffness_figure_stacks_to_the_total():
    """The top edge of the stacked compliances is the sum, at the scale of the axis."""
    curve = fixture.curve()
    drawn = stiffness_ink(curve, fixture.requirements()[2])
    areas = [
        m
        for m in drawn.marks
        if "path" in m and m["fill"] in figures.AREAS and m["closed"] and len(m["path"][0]) > 50
    ]
    count = len(curve.position)
    top = [p[1] for p in areas[-1]["path"][0][:count]]
    base = areas[0]["path"][0][-1][1]
    heights = [base - y for y in top]
    total = [1 / k for k in curve.stiffness]
    ratio = max(heights) / max(total)
    assert heights == pytest.approx([ratio * c for c in total], abs=0.01)
    assert overlaps(drawn.text_boxes()) == []


@pytest.mark.parametrize("limit", [2e6, 9.5e6, 10e6, 10.4e6, 14e6])
def test_stiffness_labels_stay_apart(limit):
    """The minimum and the requirement may coincide or not: labels never overlap."""
    row = replace(fixture.requirements()[2], limit=limit)
    assert overlaps(stiffness_ink(fixture.curve(), row).text_boxes()) == []


def test_degenerate_curves_do_not_fail():
    """A stroke of one point has no figure; a curve without requirement has one."""
    curve = fixture.curve()
    single = replace(
        curve, position=curve.position[:1], stiffness=curve.stiffness[:1], contributions={}
    )
    assert stiffness_page.stiffness_panels(single, None) == []
    assert stiffness_ink(curve, None).marks
