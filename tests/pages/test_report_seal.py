"""The seal sheet: gland to scale, figures, tables, sentences, and the document of its own."""

from __future__ import annotations

import doctest
import itertools
import math
import re
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
import report_fixture as fixture
from test_through_wall import text_of

import actuator_opt as ao
from actuator_opt.evaluation import compute
from actuator_opt.pages import seal, seal_figures, seal_sections
from actuator_opt.pages.report import page
from actuator_opt.rendering import contours, paper, paper_plain as fallback, terminal, text
from actuator_opt.rendering.blocks import Origin
from actuator_opt.rendering.ink import PALE, Ink
from actuator_opt.studies import seal as studies
from actuator_opt.studies.seal import study

ORIGIN = Origin("a: 1\n", "a.yaml", "x", "12ab")
RING = """
    type: o_ring
    compound: nbr_90
    section: 1.78 mm
    squeeze: 14 %
    tolerance: 0.05 mm
    section_tolerance: 0.08 mm
    friction: film
"""
BACKED = "    back_up: both\n    back_up_material: back_up_ptfe\n    back_up_thickness: 1.1 mm\n"
GUIDE = "    guide:\n      material: guide_acetal\n      thickness: 1 mm\n      width: 2 mm\n"
COMPACT = """
    type: compact
    compound: nbr_80
    section: 3 mm
    squeeze: 8 %
    width: 4 mm
    groove_width: 5 mm
    friction: film
"""
TANDEM = """
    type: step_ring
    compound: ptfe_bronze_nbr_70
    section: 1.78 mm
    squeeze: 16 %
    thickness: 1.2 mm
    width: 2.2 mm
    land: 0.6 mm
    relief: 1.4 mm
    friction: film
    secondary:
      type: u_cup
      compound: pu_94_u_cup
      section: 4 mm
      squeeze: 10 %
      thickness: 1.3 mm
      width: 4 mm
      groove_width: 6 mm
      friction: film
    wiper:
      compound: pu_94_u_cup
      section: 3 mm
      squeeze: 8 %
      thickness: 1 mm
      width: 2 mm
      groove_width: 3 mm
"""


def written(piston, rod, change=()):
    """The knee with other seals and a longer piston and head."""
    seals = f"seals:\n  piston:{piston}  rod:{rod}\n"
    text = re.sub(r"^seals:\n.*?(?=^load:)", seals, text_of("knee_bonded.yaml"), flags=re.M | re.S)
    text = text.replace("  length: 14 mm\n", "  length: 40 mm\n")
    for old, new in change:
        assert old in text
        text = text.replace(old, new)
    return text


TEXTS = {
    "rings": written(RING + BACKED, RING),
    "tandem": written(COMPACT + GUIDE, TANDEM + GUIDE),
    "short": written(
        COMPACT + GUIDE, RING + GUIDE, change=(("  length: 40 mm\n", "  length: 9 mm\n"),)
    ),
}


@pytest.fixture(scope="module", autouse=True)
def fewer_speeds():
    """Every third speed and second pressure of curves and maps: films are most of the time."""
    with pytest.MonkeyPatch.context() as patch:
        for name, step in (("CURVE_SPEEDS", 3), ("MAP_SPEEDS", 3), ("MAP_SHARES", 2)):
            patch.setattr(studies, name, getattr(studies, name)[::step])
        yield


@cache
def studied(name, place, **point):
    """A place of one of the designs above, with curves and map."""
    return study(ao.read(TEXTS[name]).subject(), place, curves=True, mapped=True, **point)


@cache
def failed():
    """A step ring alone, relieved so far that the supply pressure lifts it off the rod."""
    alone = re.sub(r"^    secondary:\n(?:      .*\n)+", "", TANDEM, flags=re.M)
    lifted = alone.replace("land: 0.6 mm", "land: 0.1 mm").replace("1.4 mm", "2.1 mm")
    subject = ao.read(written(COMPACT + GUIDE, lifted + GUIDE)).subject()
    return study(subject, "rod", curves=True, mapped=True)


CASES = [("rings", "piston"), ("rings", "rod"), ("tandem", "piston"), ("tandem", "rod")]
EVERY = [*CASES, ("short", "piston"), ("short", "rod")]


def ink_of(block):
    """The drawing of a block."""
    ink = Ink(block["ink"]["width"], block["ink"]["height"])
    ink.marks = block["ink"]["marks"]
    return ink


def plain(cell):
    """A cell as text."""
    return cell if isinstance(cell, str) else "".join(cell)


def blocks(one):
    """The blocks of a place in the report of a design, as the template gets them."""
    return paper.plain_blocks(seal.blocks(one))


def sheet(one):
    """The page of a place, as the template gets it."""
    return paper.plain(seal.page(one), ORIGIN)


def shown(one, *, width=100, unicode=True):
    """The page of a place on the terminal."""
    return terminal.text(seal.page(one), colour=False, unicode=unicode, width=width)


def by_title(one, end):
    """The block whose title ends so."""
    return next(b for b in blocks(one) if b["title"].endswith(end))


def first_number(words):
    """The number a text begins with, SI prefixes aside."""
    words = words.replace("−", "-").replace("\N{NARROW NO-BREAK SPACE}", "")
    return float(re.match(r"-?[\d.]+", words)[0])


def area(points):
    """Area of a polygon."""
    pairs = zip(points, [*points[1:], points[0]], strict=True)
    return abs(sum(a[0] * b[1] - b[0] * a[1] for a, b in pairs)) / 2


# ---- gland ----


@pytest.mark.parametrize(("name", "place"), EVERY)
@pytest.mark.long
def test_the_gland_is_true_to_scale(name, place):
    """Width and depth of every groove on paper are those of the design by one factor."""
    one = studied(name, place)
    drawing = seal_sections.gland_drawing(one)
    paper, real = map(int, drawing.scale.split(":"))
    assert drawing.millimetres_per_metre == 1000 * paper / real
    slots = seal_sections.filled_grooves(one.design, place)
    edges = [m["path"][0] for m in drawing.ink.marks if "path" in m and not m["closed"]]
    edge = next(line for line in edges if len(line) == 4 * len(slots) + 2)
    surface = next(m["path"][1] for m in drawing.ink.marks if "path" in m and m["path"][0] == edge)
    assert abs(edge[0][1] - surface[0][1]) == pytest.approx(
        one.clearance * drawing.millimetres_per_metre, abs=2e-3
    )
    for k, slot in enumerate(slots):
        left, floor, right = (np.array(edge[4 * k + j]) for j in (1, 2, 3))
        assert right[0] - left[0] == pytest.approx(
            slot.width * drawing.millimetres_per_metre, abs=2e-3
        )
        assert abs(floor[1] - surface[0][1]) == pytest.approx(
            slot.depth * drawing.millimetres_per_metre, abs=2e-3
        )


def test_a_round_ring_keeps_its_section():
    """Squeezed between floor and surface an O-ring has the area of its circle."""
    for name, place in (("rings", "rod"), ("tandem", "rod")):
        (ring,) = [
            shape
            for slot in seal_sections.filled_grooves(studied(name, place).design, place)
            if slot.groove.place == "rod seal"
            for shape in slot.shapes
            if shape.kind == "elastomer"
        ]
        assert area(ring.points) == pytest.approx(math.pi / 4 * 1.78e-3**2, rel=3e-3)
    slot = seal_sections.filled_grooves(studied("rings", "rod").design, "rod")[0]
    heights = [r for _, r in slot.shapes[0].points]
    assert (min(heights), max(heights)) == pytest.approx((0.0, 0.86 * 1.78e-3), abs=1e-9)


def test_rings_touch_the_surface_and_stay_in_their_groove():
    """What is mounted lies between surface and floor and between the walls of its groove."""
    for name, place in EVERY:
        for slot in seal_sections.filled_grooves(studied(name, place).design, place):
            mounted = [shape for shape in slot.shapes if shape.kind != "free"]
            points = [p for shape in mounted for p in shape.points]
            assert min(r for _, r in points) == pytest.approx(0.0, abs=1e-9)
            assert max(r for _, r in points) == pytest.approx(slot.depth, rel=1e-9)
            assert min(x for x, _ in points) >= -1e-9
            assert max(x for x, _ in points) <= slot.width + 1e-9


def test_back_up_rings_stand_on_both_sides():
    """The ring lies between its two back-up rings, each as thick as stated."""
    slot = seal_sections.filled_grooves(studied("rings", "piston").design, "piston")[0]
    backs = [shape.points for shape in slot.shapes if shape.kind == "back-up"]
    ends = sorted((min(x for x, _ in p), max(x for x, _ in p)) for p in backs)
    assert ends[0] == pytest.approx((0.0, 1.1e-3))
    assert ends[1] == pytest.approx((slot.width - 1.1e-3, slot.width))
    ring = next(shape for shape in slot.shapes if shape.kind == "elastomer")
    assert ends[0][1] < min(x for x, _ in ring.points)
    assert max(x for x, _ in ring.points) < ends[1][0]


def test_sizes_carry_their_tolerances():
    """Gland depth and section are printed with what the design allows them."""
    ink = seal_sections.gland_drawing(studied("rings", "rod")).ink
    words = {mark["text"] for mark in ink.marks if "text" in mark}
    assert {"1.531 ±0.05", "section 1.78 ±0.08", "rod ⌀13", "radial gap 0.03", "210 bar"} <= words
    (row,) = seal.gland_rows(studied("rings", "rod"))
    assert row[3:6] == ("1.78 ±0.08", "14 %", "1.531 ±0.05")
    piston = seal_sections.gland_drawing(studied("rings", "piston"))
    growth = studied("rings", "piston").growth
    said = next(m["text"] for m in piston.ink.marks if m.get("text", "").startswith("+ growth"))
    assert float(said.split()[-1]) == pytest.approx(1e3 * growth, rel=0.01)


def test_both_rings_of_a_pair_stand_in_their_order():
    """Guide, step ring, lip seal, wiper, from the sealed side on the left; pressures beside."""
    one = studied("tandem", "rod")
    assert [slot.groove.role for slot in seal_sections.filled_grooves(one.design, "rod")] == [
        "guide", "element", "element", "wiper",
    ]  # fmt: skip
    ink = seal_sections.gland_drawing(one).ink
    at = {mark["text"]: mark["at"][0] for mark in ink.marks if "text" in mark}
    order = ["sealed side", "guide", "seal: step ring", "secondary seal: u cup", "wiper"]
    places = [at[words] for words in [*order, "outer side"]]
    assert places == sorted(places)
    assert any(words.startswith("between the rings: ") for words in at)


# ---- figures ----


@pytest.mark.parametrize(("name", "place"), EVERY)
def test_nothing_written_collides(name, place):
    """In every figure no two texts overlap, all stay on the paper, and so does every line."""
    checked = 0
    for block in [*blocks(studied(name, place)), *blocks(failed())]:
        if block["kind"] != "figure":
            continue
        checked += 1
        ink = ink_of(block)
        boxes = ink.text_boxes()
        for words, left, top, right, bottom in boxes:
            assert min(left, ink.width - right) > -0.5, (block["title"], words)
            assert min(top, ink.height - bottom) > -0.5, (block["title"], words)
        for one, other in itertools.combinations(boxes, 2):
            apart = one[3] <= other[1] or other[3] <= one[1]
            assert apart or one[4] <= other[2] or other[4] <= one[2], (one, other)
        points = [p for mark in ink.marks if "path" in mark for line in mark["path"] for p in line]
        assert all(-0.01 <= x <= ink.width + 0.01 for x, _ in points), block["title"]
        assert all(-0.01 <= y <= ink.height + 0.01 for _, y in points), block["title"]
    assert checked >= 8


def test_squeeze_bars_span_from_loosest_to_tightest():
    """Each bar ends where the axis' own labels put the study's values; limits stand in red."""
    one = studied("rings", "piston")
    ink = seal_figures.squeeze_figure(one)
    ends = {m["text"]: m["at"][0] for m in ink.marks if m.get("anchor") == "center" and "text" in m}
    scale = (ends["20"] - ends["0"]) / 20
    drawn = [m["path"][0] for m in ink.marks if m.get("fill") == seal_figures._BAR]
    assert len(drawn) == len(one.squeezes) == 6
    for bar, row in zip(drawn, one.squeezes, strict=True):
        low, high = (ends["0"] + 100 * v * scale for v in (row.loosest, row.tightest))
        assert [bar[0][0], bar[1][0]] == pytest.approx([low, high], abs=0.02)
    assert {"≥ 8 %", "≤ 25 %"} <= set(ends)


def test_a_lost_contact_is_red_and_said():
    """A ring whose loosest squeeze is below zero is drawn red and named in the note."""
    one = studied("rings", "rod")
    rows = (replace(one.squeezes[0], loosest=-0.01), *one.squeezes[1:])
    lost = replace(one, squeezes=rows)
    assert "Red: the ring loses contact." in by_title(lost, "squeeze")["note"]
    fills = [m.get("fill") for m in seal_figures.squeeze_figure(lost).marks]
    assert seal_figures.RED in fills
    assert "Red" not in by_title(one, "squeeze")["note"]


def test_contact_curves_are_those_of_the_study():
    """Static contact, oil and asperities of both strokes in MPa over the width in mm."""
    one = studied("rings", "rod")
    panels = seal_figures.contact_panels(one, 0)
    for panel, point in zip(panels[:2], (one.drive.rings[0], one.other.rings[0]), strict=True):
        curves = {curve.words: curve for curve in panel.curves}
        assert panel.y.range[1] > 1e-6 * point.static.max()
        for words in ("static", "oil", "asperities"):
            own = point.asperity if words == "asperities" else getattr(point, words)
            assert curves[words].ys == pytest.approx(1e-6 * own)
            assert curves[words].xs == pytest.approx(1e3 * point.x)
    films = [curve.ys for curve in panels[2].curves]
    assert films[0] == pytest.approx(1e6 * one.drive.rings[0].film)
    assert films[1] == pytest.approx(1e6 * one.other.rings[0].film)


def test_curves_over_speed_and_their_marks_lie_inside():
    """A curve per pressure in N and kN s/m; every value above zero lies within its axis."""
    for name, place in CASES:
        one = studied(name, place)
        friction, damping = seal_figures.speed_panels(one, one.curves)
        assert [curve.end for curve in friction.curves] == [
            text.bars(float(pressure)) for pressure in one.curves.pressures
        ]
        for panel, rows in ((friction, one.curves.friction), (damping, one.curves.damping / 1e3)):
            for curve, row in zip(panel.curves, rows, strict=True):
                assert curve.ys == pytest.approx(row, nan_ok=True)
            low, high = panel.y.range
            shown = [*rows.ravel(), *(y for marks in panel.points for y in marks.ys)]
            assert all(low < y < high for y in shown if y > 0)
        marks = {marks.words.split(",")[0]: marks for marks in friction.points}
        assert marks["operating point"].ys == [one.drive.friction]
        assert marks["by the coefficient of friction"].ys == [one.drive.coefficient_friction]


def test_a_gap_in_the_map_stays_white():
    """Points without a film carry a cross and are counted; the map is hatched there."""
    one = studied("tandem", "rod")
    parts = one.map.parts.copy()
    parts[0, -2:] = np.nan
    why = ((1.0, 1.0, "9e5 Pa: no"), (1.0, 2.0, "no film at 3 mm"))
    gap = replace(one, map=replace(one.map, parts=parts, why=why))
    missing = int(np.sum(~np.isfinite(gap.map.friction)))
    for panel in seal_figures.map_panels(gap, gap.map):
        (crosses,) = [marks for marks in panel.points if marks.words == "no film"]
        assert len(crosses.xs) == len(crosses.ys) == missing
    block = by_title(gap, "speed and pressure")
    assert f"{len(why)} of {one.map.friction.size} points" in block["note"]
    whole = by_title(one, "speed and pressure")
    hatched = [
        [m for m in ink_of(b).marks if m.get("stroke") == PALE and m["pen"] == 0.1]
        for b in (block, whole)
    ]
    assert [len(marks) for marks in hatched] == [2, 0]


def test_contours_lie_where_the_values_are():
    """Friction 10 v^0 p: every level is a level line at its own pressure."""
    one = studied("rings", "rod")
    pressures = np.linspace(1e6, 11e6, 6)
    table = np.outer(pressures / 1e5, np.ones(len(one.map.speeds)))
    found = replace(one, map=replace(one.map, pressures=pressures, parts=table[:, :, None]))
    ink = ink_of(by_title(found, "speed and pressure"))
    lines = [m["path"][0] for m in ink.marks if m.get("stroke") == "#ffffff" and "path" in m]
    left = [line for line in lines if line[0][0] < 90]
    marks = [m for m in ink.marks if m.get("anchor") == "right" and m["at"][0] < 90]
    ticks = {m["text"]: m["at"][1] for m in marks}
    wanted = ticks["20"] + (ticks["100"] - ticks["20"]) * (50 - 20) / 80
    nearest = min(abs(line[0][1] - wanted) for line in left)
    assert nearest < 0.5  # bilinear in the logarithm between 30 and 50 bar nodes
    assert max(abs(p[1] - line[0][1]) for line in left for p in line) < 1e-6


def test_levels_enclose_the_values():
    """Levels are round, ascending, few, and reach beyond both ends."""
    for low, high in ((33.0, 121.0), (1.0, 2.0), (5e-5, 9e6), (100.0, 100.1)):
        found = contours.levels(low, high)
        assert found[0] <= low * (1 + 1e-6)
        assert found[-1] >= high * (1 - 1e-6)
        assert found == sorted(set(found))
        assert 2 <= len(found) <= 14


# ---- tables and sentences ----


@pytest.mark.parametrize(("name", "place"), CASES)
def test_tables_carry_the_numbers_of_the_study(name, place):
    """Friction, damping, flow and contact in the tables are those of the study, rounded."""
    one = studied(name, place)
    rows = {name: values for name, *values in seal.operating_rows(one)}
    for point, side in ((one.drive, 0), (one.other, 1)):
        value = {name: first_number(values[side]) for name, values in rows.items()}
        assert value["friction, film"] == pytest.approx(point.friction, rel=6e-4)
        assert value["part by asperities"] == pytest.approx(point.asperity, rel=6e-4)
        assert value["breakaway, dry"] == pytest.approx(point.breakaway, rel=6e-4)
        assert value["secant damping at this speed"] == pytest.approx(
            point.friction / point.speed / 1e3, rel=6e-4
        )
        assert value["flow towards the outer side"] == pytest.approx(1e9 * point.flow, rel=6e-4)
    contacts = seal.contact_rows(one)
    assert first_number(contacts[0][3]) == pytest.approx(
        1e-3 * float(one.drive.rings[0].contact.line_load), rel=6e-4
    )
    assert len(contacts) == (4 if len(one.out.rings) == 2 else 1)
    title = next(b["title"] for b in blocks(one) if ": at " in b["title"])
    assert text.speed_words(one.out.speed) in title


def test_a_double_stroke_is_what_the_strokes_leave():
    """The sentence gives the oil carried out, drawn back and left, in mm³."""
    one = studied("rings", "rod")
    said = seal.leakage(one)
    numbers = [float(x) for x in re.findall(r"([\d.]+) mm³", said)]
    out = 1e9 * one.out.flow * one.stroke / one.out.speed
    back = 1e9 * one.back.flow * one.stroke / one.back.speed
    expected = [out, abs(back), max(out + back, 0.0)]
    assert numbers == pytest.approx(expected, rel=1e-3)


def test_a_piston_is_driven_away_from_its_pressure():
    """Its strokes are driven (the bore in past the seal) and overrun; no double stroke is told.

    Heads, titles and tiles name the driven stroke, whose numbers come first.
    """
    one, rod = studied("tandem", "piston"), studied("tandem", "rod")
    assert (one.drive, one.other) == (one.back, one.out)
    assert (rod.drive, rod.other) == (rod.out, rod.back)
    assert [c["head"] for c in by_title(one, "100 mm/s, 40 °C")["columns"]][1:] == [
        "driven", "overrun",
    ]  # fmt: skip
    data = sheet(one)
    labels = [tile["label"] for tile in data["tiles"]]
    assert labels[:2] == ["friction, driven", "secant damping, driven"]
    assert first_number(data["tiles"][0]["value"]) == pytest.approx(one.back.friction, rel=6e-4)
    crossed = next(t for t in data["tiles"] if t["label"] == "flow across, driven")
    assert first_number(crossed["value"]) == pytest.approx(1e9 * one.back.flow, rel=6e-4)
    told = shown(one, width=400) + str(blocks(one)) + str(data)
    for words in ("outstroke", "instroke", "double stroke", "carried out", "the other side"):
        assert words not in told, words
    assert "Friction, driven, N" in told
    assert "overrun" not in shown(rod) + str(blocks(rod))


def test_flow_across_a_piston_is_told_with_its_way():
    """Both flows stand in the sentence without sign: out of the higher pressure, or back in."""
    one = studied("tandem", "piston")
    assert one.drive.flow < 0 < one.other.flow
    driven, overrun = seal.leakage(one).split(" Overrun: ")
    assert first_number(driven.partition("Driven: ")[2]) == pytest.approx(
        -1e9 * one.drive.flow, rel=6e-4
    )
    assert "back into" in driven
    assert first_number(overrun) == pytest.approx(1e9 * one.other.flow, rel=6e-4)
    assert "out of" in overrun


def test_json_names_the_driven_stroke():
    """A piston has the flow of both strokes and no oil left outside; a rod has all five."""
    piston, rod = (studied("rings", place).to_dict() for place in ("piston", "rod"))
    assert (piston["drive"], rod["drive"]) == ("in", "out")
    for one in (piston, rod):
        assert set(one["friction"]) == set(one["damping"]) == {"out", "in"}
        assert set(one["leakage"]) == {"flow_out", "flow_in", "carried_out", "drawn_back", "net"}
        assert one["leakage"]["flow_out"] > one["leakage"]["flow_in"]
    for name in ("carried_out", "drawn_back", "net"):
        assert piston["leakage"][name] is None
        assert rod["leakage"][name] is not None
    point = studied("rings", "rod").drive
    by_hand = sum(ring.coefficient_friction for ring in point.rings)
    assert rod["friction"]["out"]["by_coefficient"] == pytest.approx(by_hand)


def sole_case(name):
    """One of the designs without wiper, guides and variables, in its pushing load case alone."""
    swing = "  - name: swing\n    direction: pull\n    force: 4 kN\n    speed: 0.4 m/s\n"
    text = TEXTS[name].replace(GUIDE, "").replace(swing, "")
    text = re.sub(r"^    wiper:\n(?:      .*\n)+", "", text, flags=re.M)
    return ao.read(re.sub(r"^variables:\n(?:[ \n].*\n|\n)*", "", text, flags=re.M))


@pytest.mark.parametrize("name", ["rings", "tandem"])
@pytest.mark.long
def test_the_sheets_are_the_evaluation_at_its_case(name):
    """Piston and rod driven: their friction is the evaluation's within the error its tables state.

    So is the flow across the piston, unless it draws oil back. The outer side of the piston is at
    the return pressure, that of the rod at the atmosphere.
    """
    actuator = sole_case(name)
    subject = actuator.subject()
    piston, rod = (study(subject, place) for place in ("piston", "rod"))
    assert piston.outer_pressure == pytest.approx(actuator.design.supply.return_pressure)
    assert piston.drive.pressure == pytest.approx(actuator.design.supply.pressure - 5e5)
    assert (rod.outer_pressure, rod.drive.pressure) == (0.0, pytest.approx(5e5))
    found = compute(subject, subject.values()).computed.metrics
    tables = [subject.films[place, 0, "drive"] for place in ("piston", "rod")]
    friction, flow = (max(table.errors[name] for table in tables) for name in ("friction", "flow"))
    assert max(friction, flow) < 0.01
    sheets = piston.drive.friction + rod.drive.friction
    assert sheets == pytest.approx(float(np.squeeze(found["friction_running"][""])),
                                   rel=friction + 1e-6)  # fmt: skip
    across = float(np.squeeze(found["leakage"][""]))
    assert across == pytest.approx(
        max(piston.drive.flow, 0.0), abs=(flow + 1e-6) * abs(piston.drive.flow)
    )


def test_a_film_that_fails_is_a_sentence_and_no_figure():
    """Without a film the sheet says why, draws no profile, and prints dashes for its numbers."""
    one = failed()
    assert one.out.why
    found = blocks(one)
    assert not any(b["title"].endswith("oil film") for b in found)
    table = next(b for b in found if ": at " in b["title"])
    assert f"No oil film on the outstroke: {one.out.why}" in table["note"]
    friction = next(row for row in table["rows"] if row[0] == "friction, film")
    assert friction[1] == "–"
    assert float(one.out.rings[0].contact.line_load) == 0
    assert (one.out.breakaway, one.out.coefficient_friction) == (0.0, 0.0)  # nothing presses
    data = sheet(one)
    assert data["verdict"]["state"] == "missed"
    assert one.out.why.split(":")[0] in plain(data["sentence"])
    assert one.out.why.split()[0] in shown(one, width=400)


def test_no_map_and_no_curves_give_no_figure():
    """What was not asked for is not drawn; nothing but missing points is neither."""
    one = replace(studied("rings", "rod"), map=None, curves=None)
    titles = [b["title"] for b in blocks(one)]
    assert not any("over speed" in title for title in titles)
    bare = studied("rings", "rod").map
    empty = replace(one, map=replace(bare, parts=np.full_like(bare.parts, np.nan)))
    assert [b["title"] for b in blocks(empty)] == titles
    assert "damping B over speed" not in shown(one)


def test_notes_tell_model_from_input():
    """The sheet says what its film model cannot know and what was never measured."""
    said = " ".join(seal.notes(studied("tandem", "rod")))
    for words in (
        "orders of magnitude from the literature",
        "even at rest",
        "proportional",
        "not the damping",
    ):
        assert words in said


# ---- paper and terminal ----


@pytest.mark.parametrize("width", [60, 80, 120])
def test_terminal_text_keeps_its_width(width):
    """No line is longer than the terminal, also in plain ASCII."""
    for one in (studied("tandem", "rod"), studied("rings", "piston"), failed()):
        assert max(map(len, shown(one, width=width).splitlines())) <= width
        assert shown(one, width=width, unicode=False).isascii()
    words = shown(studied("rings", "rod"), width=width)
    assert f"{studied('rings', 'rod').out.friction:.4g}" in words


@pytest.mark.long
def test_the_sheet_is_a_document_with_equal_bytes(tmp_path):
    """PDF and PNG of one place, the same bytes again; the plain renderer can draw it too."""
    given = {"stem": "s"}
    one = studied("rings", "rod")
    first = paper.write(seal.page(one), ORIGIN, folder=tmp_path / "1", **given)
    again = study(ao.read(TEXTS["rings"]).subject(), "rod", curves=True, mapped=True)
    second = paper.write(seal.page(again), ORIGIN, folder=tmp_path / "2", **given)
    assert [f.sha256 for f in first] == [f.sha256 for f in second]
    assert {f.path.name for f in first} >= {"s.pdf", "s.png"}
    data = sheet(one)
    data |= {"title": "x", "source": "a: 1\n", "source_file": "a.yaml", "run": "{}"}
    assert fallback.render(data, 0)[1]
    assert ao.rendering.attachments.read_attachment(tmp_path / "1" / "s.pdf").source == "a: 1\n"


def test_the_report_carries_the_sheets(tmp_path):
    """Given studies, the design's report holds their blocks; without, it has none."""
    evaluation = ao.evaluate(ao.read(TEXTS["rings"]))
    source = {"source_text": "a: 1\n", "source_name": "a.yaml", "command": "x", "date": None}
    titles = [block.title for block in page(evaluation).blocks]
    assert not any("Rod seals" in title for title in titles)
    both = [studied("rings", place) for place in ("piston", "rod")]
    titles = [block.title for block in page(evaluation, seals=both).blocks]
    assert {"Piston seals: gland", "Rod seals: gland"} <= set(titles)
    files = fixture.write_report(evaluation, folder=tmp_path, stem="r", seals=both, **source)
    assert files[0].pages > 3


@pytest.mark.parametrize("module", [contours, seal, seal_figures, seal_sections, text])
def test_examples_in_docstrings(module):
    """The worked examples hold."""
    assert doctest.testmod(module).failed == 0
