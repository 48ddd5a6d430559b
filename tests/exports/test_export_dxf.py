"""The DXF section: true lengths, a layer per part, nothing over anything."""

from __future__ import annotations

import io
import math
import os
import subprocess
import sys
from functools import cache
from itertools import combinations, pairwise
from pathlib import Path

import pytest
from cli_runner import DESIGNS, bench, block
from hypothesis import given, strategies as st
from shipped import evaluated
from test_export_step import EACH, FITTED_ROD, VARIANTS

import actuator_opt as ao
from actuator_opt.exports.dxf import DrawingSizes, Length, dxf, layer_name, rows

ezdxf = pytest.importorskip("ezdxf")
bbox = pytest.importorskip("ezdxf.bbox")
fonts = pytest.importorskip("ezdxf.fonts.fonts")


def drawn(source):
    """Evaluation and the document read back, which ezdxf finds no fault with."""
    evaluation = evaluated(source.stem) if isinstance(source, Path) else ao.evaluate(source)
    content = dxf(evaluation, program="test")
    document = ezdxf.read(io.StringIO(content.decode("utf-8")))
    audit = document.audit()
    assert not audit.errors
    assert not audit.fixes
    return evaluation, document


@cache
def shipped(path):
    """The same of a shipped design, for all tests that read it."""
    return drawn(path)


def box(entity, words=None):
    """Left, bottom, right, top of a text on one line, by ezdxf's own fonts."""
    if words is not None:  # MTEXT, placed by its middle
        height, (x, y) = entity.dxf.char_height, tuple(entity.dxf.insert)[:2]
        assert entity.dxf.attachment_point == 5
        assert "\n" not in words
        half = fonts.make_font("arial.ttf", height).text_width(words) / 2
        return x - half, y - 0.6 * height, x + half, y + 0.6 * height
    found = bbox.extents([entity], fast=False)
    return found.extmin.x, found.extmin.y, found.extmax.x, found.extmax.y


def meets(a, b):
    """Whether two boxes overlap."""
    return a[0] < b[2] and b[0] < a[2] and a[1] < b[3] and b[1] < a[3]


def hits(line, area):
    """Whether a straight line enters a box: Liang and Barsky."""
    (x, y), (far, high) = line
    low, up = 0.0, 1.0
    for p, q in (
        (x - far, x - area[0]), (far - x, area[2] - x), (y - high, y - area[1]),
        (high - y, area[3] - y),
    ):  # fmt: skip
        if p == 0:
            if q <= 0:
                return False
        elif p < 0:
            low = max(low, q / p)
        else:
            up = min(up, q / p)
    return low < up


def outlined(document, layer):
    """Corners (x, y, bulge) of the closed lines of a layer."""
    lines = document.modelspace().query(f'LWPOLYLINE[layer=="{layer}"]')
    return [[(x, y, bulge) for x, y, *_, bulge in one.get_points("xyseb")] for one in lines]


def layer(part):
    """The layer of a part of the outlines."""
    return f"barrel.{part}" if part[:5] == "layup" else {"glands": "head"}.get(part, part)


def swept(lines):
    """Volume of closed lines' upper halves about the axis, pi times the integral of y^2 dx."""
    total = 0.0
    for line in lines:
        piece = 0.0
        for (x1, y1, _), (x2, y2, _) in zip(line, line[1:] + line[:1], strict=True):
            if y1 >= 0 and y2 >= 0:
                piece += math.pi / 3 * (x2 - x1) * (y1 * y1 + y1 * y2 + y2 * y2)
        total += abs(piece)
    return total * 1e-9


@pytest.mark.parametrize("path", EACH, ids=lambda path: path.stem)
def test_swept_sections_weigh_what_the_mass_model_says(path):
    """What the lines of a part's layer sweep is its mass (Pappus)."""
    actuator = ao.read(path)
    evaluation, document = shipped(path)
    materials = actuator.subject().materials
    found = {}
    for one in evaluation.outlines:
        if one.kind in ("metal", "composite", "polymer") and " " not in one.part:
            mass = (
                swept(outlined(document, layer(one.part)))
                * materials[one.material].numbers["density"]
            )
            group = "barrel" if one.part[:5] == "layup" or one.part == "sleeves" else one.part
            found[group] = found.get(group, 0.0) + mass
    for group, mass in found.items():
        assert mass == pytest.approx(evaluation.mass_parts[group], rel=1e-9), group
    assert {"barrel", "rod", "piston", "caps", "glands"} <= set(found)


def dimensions(document):
    """Every dimension of the model space."""
    return document.modelspace().query("DIMENSION")


def test_dimensions_measure_the_design():
    """DIMLFAC 1, and the measurements are the evaluation's lengths in mm."""
    evaluation, document = shipped(DESIGNS / "knee_bonded.yaml")
    assert document.header["$INSUNITS"] == 4
    lengths = {name: 1000 * value for name, value in evaluation.lengths.items()}
    measured = sorted(one.get_measurement() for one in dimensions(document))
    skirt = 1000 * ao.read(DESIGNS / "knee_bonded.yaml").design.retention.length
    names = ("bore", "rod", "rod_inner", "barrel_outer_diameter", "plate_outer", "pin", "stroke",
             "piston_length", "head_length", "barrel_length", "plate", "plate", "extension",
             "closed_length")  # fmt: skip
    wanted = sorted([*(lengths[name] for name in names), skirt])
    assert measured == pytest.approx(wanted, abs=1e-6)
    for one in dimensions(document):
        assert one.override().get("dimlfac") == 1.0
        shown = "".join(text.plain_text() for text in one.get_geometry_block().query("MTEXT"))
        value = f"{one.get_measurement():.3f}".rstrip("0").rstrip(".")
        assert value in shown.split() or f"Ø{value}" in shown or f"⌀{value}" in shown, shown


def check_nothing_overlaps(document):
    """Texts keep clear of each other, of lines of dimensions, and of the parts."""
    space = document.modelspace()
    texts, lines = [], []
    for index, one in enumerate(dimensions(document)):
        for part in one.get_geometry_block():
            if part.dxftype() == "MTEXT":
                texts.append((index, part.plain_text(), box(part, part.plain_text())))
            elif part.dxftype() == "LINE":
                lines.append((index, (part.dxf.start.vec2, part.dxf.end.vec2)))
    for part in space.query('LWPOLYLINE[layer=="dimensions"]'):
        corners = [(x, y) for x, y, *_ in part.get_points()]
        lines += [(-1, pair) for pair in pairwise(corners)]
    words = [(-1, one.dxf.text, box(one)) for one in space.query("TEXT")]
    for (_, one, a), (_, other, b) in combinations([*texts, *words], 2):
        assert not meets(a, b), (one, other)
    for index, one, area in texts:
        for owner, line in lines:
            line = [tuple(point)[:2] for point in line]
            assert owner == index or not hits(line, area), (one, line)
    parts = bbox.extents(one for one in space.query("LWPOLYLINE") if one.dxf.layer != "dimensions")
    for _, one, area in [*texts, *words]:
        assert area[1] > parts.extmax.y or area[3] < parts.extmin.y, one


@pytest.mark.parametrize("path", EACH, ids=lambda path: path.stem)
def test_nothing_overlaps_in_shipped_designs(path):
    """By the boxes of ezdxf's fonts."""
    check_nothing_overlaps(shipped(path)[1])


@pytest.mark.parametrize("name", [*VARIANTS, "layers"])
def test_nothing_overlaps_whatever_the_design_has(name):
    """Nor without caps, eyes, skirts, nor with rods of layers; odd lengths have long texts."""
    changes = VARIANTS.get(name, ((block("rod"), FITTED_ROD),))
    odd = {"cylinder.stroke": "63.217 mm", "piston.length": "14.333 mm", "head.length": "15.123 mm"}
    design = ao.read(bench(*changes), set=odd)
    evaluation, document = drawn(design)
    check_nothing_overlaps(document)
    layers = {one.dxf.name for one in document.layers}
    for one in evaluation.outlines:
        if one.kind != "oil":
            assert layer_name(layer(one.part)) in layers
            assert document.modelspace().query(f'HATCH[layer=="{layer(one.part)}"]')


def test_every_colour_shows_on_black_and_on_white():
    """Contrast of 3:1 at least on either ground [WCAG 1.4.11]; letters are black or white (7)."""
    document = shipped(DESIGNS / "knee_bonded.yaml")[1]
    colours = ezdxf.colors

    def luminance(index):
        channels = [x / 255 for x in colours.int2rgb(colours.DXF_DEFAULT_COLORS[index])]
        linear = [x / 12.92 if x <= 0.04045 else ((x + 0.055) / 1.055) ** 2.4 for x in channels]
        return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]

    layers = {one.dxf.name: one.dxf.color for one in document.layers}
    for index in {*layers.values()} - {7}:
        light = luminance(index)
        assert min(1.05 / (light + 0.05), (light + 0.05) / 0.05) > 3.0, index
    space = document.modelspace()
    assert layers["text"] == 7
    assert all(text.dxf.color == 256 for text in space.query("TEXT"))
    for dimension in space.query("DIMENSION"):
        block = document.blocks[dimension.dxf.geometry]
        assert {text.dxf.color for text in block.query("TEXT MTEXT")} == {7}
        assert {line.dxf.color for line in block.query("LINE INSERT SOLID")} == {256}
    assert all(one.dxf.color == 256 for one in space.query("LWPOLYLINE HATCH LINE"))


def test_eyes_are_round():
    """Lug and hole are arcs of the pin's proportions: 3/4 pi d^2 of lug, and the neck."""
    evaluation, document = shipped(DESIGNS / "knee_bonded.yaml")
    d = 1000 * evaluation.lengths["pin"]
    for layer in ("cap eye", "rod eye"):
        lug, hole = outlined(document, layer)
        areas = []
        for line in (lug, hole):
            area = 0.0
            for (x1, y1, bulge), (x2, y2, _) in zip(line, line[1:] + line[:1], strict=True):
                chord = math.dist((x1, y1), (x2, y2))
                area += (x1 * y2 - x2 * y1) / 2
                if bulge:
                    angle = 4 * math.atan(abs(bulge))
                    radius = chord / 2 / math.sin(angle / 2)
                    area += math.copysign(radius**2 / 2 * (angle - math.sin(angle)), bulge)
            areas.append(abs(area))
        foot = math.sqrt(3) / 2 * d
        segment = d * d / 2 * (math.pi / 3 - math.sqrt(3) / 2)  # of 60 degrees, under the neck
        neck = d * (2 * d - foot)
        assert areas == pytest.approx([math.pi * d * d - segment + neck, math.pi * d * d / 4])


def test_an_odd_number_of_tie_rods_has_none_opposite():
    """The first lies in the plane of the section; of five, none lies on its other side."""
    for count, shapes in ((5, 1), (6, 2)):
        source = ao.read(DESIGNS / "aerospace.yaml", set={"retention.count": count})
        _, document = drawn(source)
        assert len(outlined(document, "tie rods")) == shapes


@pytest.mark.parametrize(("diameter", "size"), [(None, "M27 x 1"), ("26.9 mm", "M26.9 x 1")])
def test_the_thread_of_screwed_caps_is_named(diameter, size):
    """Not drawn, it stands in the notes: as large as the barrel, or as stated."""
    stated = {} if diameter is None else {"retention.thread.diameter": diameter}
    wall = {"barrel.layup[0].thickness": "2 mm", "retention.thread.pitch": "1 mm"}
    _, document = drawn(ao.read(DESIGNS / "steel_baseline.yaml", set=wall | stated))
    texts = [one.dxf.text for one in document.modelspace().query("TEXT")]
    assert f"Thread of barrel and caps: {size}, 10 long." in texts


def test_a_persons_words_stay_words():
    """Codes, letters and line breaks of a name neither break the file nor start anything."""
    name = '"%%c 5 管 \\\\U+0041 a"'
    _, document = drawn(ao.read(bench(("name: test bench", f"name: {name}"))))
    texts = [one.dxf.text for one in document.modelspace().query("TEXT")]
    assert any("管" in text and "%%" not in text for text in texts)


def test_same_design_same_bytes():
    """No clock and no random identifier; ezdxf's own option is as before."""
    before = ezdxf.options.write_fixed_meta_data_for_testing
    evaluation = ao.evaluate(bench())
    assert dxf(evaluation, program="p") == dxf(evaluation, program="p")
    assert ezdxf.options.write_fixed_meta_data_for_testing == before


@pytest.mark.long
def test_same_bytes_in_another_process(tmp_path):
    """Not even the order of sets, which differs from process to process, is in the file."""
    file, found = tmp_path / "d.yaml", set()
    file.write_text(bench(), encoding="utf-8")
    code = "import sys, actuator_opt as ao; ao.export(sys.argv[1], formats='dxf', folder='.')"
    for number in "12345":
        seeded = os.environ | {"PYTHONHASHSEED": number}
        subprocess.run([sys.executable, "-c", code, file], cwd=tmp_path, env=seeded, check=True)
        found.add((tmp_path / "d.dxf").read_bytes())
    assert len(found) == 1


@given(
    st.lists(st.tuples(st.floats(-100, 300), st.floats(0.01, 300)), min_size=1, max_size=12),
    st.sampled_from([0.1, 0.5, 1.0, 2.0, 5.0]),
)
def test_any_lengths_find_their_rows(spans, scale):
    """No text meets a text of its row, nor an extension line that passes its row."""
    paper = DrawingSizes(scale)
    placed = rows([Length(a, a + size, f"{size:.3f}") for a, size in spans], paper)
    for one in placed:
        half = paper.width(one.length.text) / 2
        for other in placed:
            if other is one:
                continue
            if other.row == one.row:
                apart = abs(one.middle - other.middle)
                assert apart >= half + paper.width(other.length.text) / 2
            if other.row >= one.row:
                for x in (other.length.start, other.length.end):
                    own = x in (one.length.start, one.length.end)
                    assert own or not abs(x - one.middle) < half
