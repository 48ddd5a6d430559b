"""Finite elements on the seal sheet: sections to scale, stress bands, contact over pressure."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from report_fixture import overlaps
from step_ring_case import SECTION, SHAPE, SQUEEZE, seal as step_seal
from test_report_seal import TEXTS, area, blocks, ink_of, shown

import actuator_opt as ao
from actuator_opt.evaluation.kernel import base
from actuator_opt.evaluation.sealing import closed_form, room
from actuator_opt.finite_elements.material import MooneyRivlin
from actuator_opt.finite_elements.o_ring import squeezed_ring
from actuator_opt.finite_elements.section import StressField
from actuator_opt.pages import seal, seal_figures, seal_sections as drawn
from actuator_opt.rendering import contours, text
from actuator_opt.studies.seal import study


def with_ring(one, ring):
    """The study with other numbers of its first ring."""
    points = [
        replace(point, rings=(replace(point.rings[0], ring=ring), *point.rings[1:]))
        for point in (one.out, one.back)
    ]
    return replace(one, out=points[0], back=points[1])


@cache
def solved(name):
    """A study of the knee's rod with a coarse solution: an O-ring, or a step ring."""
    if name == "o_ring":
        one = study(ao.read(TEXTS["rings"]).subject(), "rod")
        ring = one.out.rings[0].ring
        found = squeezed_ring(
            section=ring["section"],
            squeeze=ring["squeeze"],
            groove_width=room(ring),
            rubber=MooneyRivlin.of_modulus(ring["youngs_modulus"]),
            pressures=[5e6, 10e6, 21e6],
            elements_around=32,
        )
    else:
        one = study(ao.read(TEXTS["tandem"]).subject(), "rod")
        found = step_seal(2e6, 5e6)
        sizes = {"width": SHAPE.width, "thickness": SHAPE.thickness, "section": SECTION}
        sizes |= {"squeeze": SQUEEZE, "groove_width": SHAPE.width + 0.2e-3}
        one = with_ring(one, one.out.rings[0].ring.at(**sizes))
    assert found.failure is None
    return replace(one, elements=found.contacts)


BOTH = ["o_ring", pytest.param("step_ring", marks=pytest.mark.long)]


def bands_of(field, levels):
    """Outlines of the bands of stress."""
    values = contours.corner_values(field.nodes, field.triangles, field.von_mises)
    return contours.mesh_bands(field.nodes, field.triangles, values, levels)


def outlines_of(field):
    """Outlines of the bodies."""
    return contours.mesh_outlines(field.nodes, field.triangles, field.body)


def words_of(ink):
    """Every text of a drawing."""
    return [mark["text"] for mark in ink.marks if "text" in mark]


def paths(ink, **wanted):
    """The polylines of marks with these properties."""
    return [
        mark["path"]
        for mark in ink.marks
        if "path" in mark and all(mark[name] == value for name, value in wanted.items())
    ]


# ---- stress ----


@pytest.mark.long
@pytest.mark.parametrize("name", BOTH)
def test_words_under_the_sections_are_the_solution(name):
    """Pressure, highest stress and contact width of every section, rounded to three digits."""
    one = solved(name)
    said = words_of(drawn.stress_figure(one))
    for contact in one.elements:
        highest = float(contact.field.von_mises.max()) / 1e6
        shown = [float(w.split()[2]) for w in said if w.startswith("up to ")]
        assert min(abs(value - highest) for value in shown) < 6e-3 * highest
        wide = [float(w.split()[1]) for w in said if w.startswith("contact ")]
        assert min(abs(value - 1e3 * contact.width) for value in wide) < 6e-3
    assert sum(w.startswith("up to ") for w in said) == len(one.elements)
    assert "0 bar, mounted" in said


@pytest.mark.long
@pytest.mark.parametrize("name", BOTH)
def test_sections_are_to_scale_in_their_groove(name):
    """Every body keeps its area times the scale, between walls and face; contacts in red there."""
    one = solved(name)
    ink = drawn.stress_figure(one)
    paper, real = drawn.stress_scale(one)
    factor = 1000 * paper / real
    grooves = [path for path in paths(ink, fill=None) if len(path) == 2 and len(path[0]) == 4]
    bodies = [path[0] for path in paths(ink, pen=0.15)]
    each = len(bodies) // len(one.elements)
    reds = [path[0] for path in paths(ink, stroke=drawn.RED)]
    wide, deep = drawn.gland_sizes(one.out.rings[0].ring)
    for k, contact in enumerate(one.elements):
        groove, face = (np.array(part) for part in grooves[k])
        assert np.ptp(groove[:, 0]) == pytest.approx(wide * factor, abs=2e-3)
        assert np.ptp(groove[:, 1]) == pytest.approx(deep * factor, abs=2e-3)
        points = np.concatenate(bodies[each * k : each * (k + 1)])
        assert groove[:, 0].min() - 0.1 < points[:, 0].min()
        assert points[:, 0].max() == pytest.approx(groove[:, 0].max(), abs=2e-3)
        assert points[:, 1].min() == pytest.approx(groove[:, 1].min(), abs=0.02)
        assert points[:, 1].max() == pytest.approx(face[0, 1], abs=0.02)
        section = math.pi / 4 * one.out.rings[0].ring["section"] ** 2 * factor**2
        assert area(bodies[each * k]) == pytest.approx(section, rel=0.02)  # polygons, mesh of 32
        (start, _), (end, y) = reds[k]
        assert end - start == pytest.approx(contact.width * factor, abs=2e-3)
        assert groove[:, 0].max() + contact.start * factor == pytest.approx(start, abs=2e-3)
        assert y == pytest.approx(face[0, 1])


@pytest.mark.parametrize("name", BOTH)
@pytest.mark.long
def test_the_colour_scale_covers_the_field(name):
    """Levels rise evenly from zero past the highest stress, each written, one colour a band."""
    one = solved(name)
    levels = drawn.stress_levels(one)
    assert levels[0] == 0
    assert levels[-1] >= max(float(c.field.von_mises.max()) for c in one.elements)
    assert np.diff(levels) == pytest.approx(levels[1])
    assert 4 <= len(levels) - 1 <= drawn.MOST_BANDS
    ink = drawn.stress_figure(one)
    scale = [m["fill"] for m in ink.marks if m.get("pen") == 0.1 and m.get("closed")]
    assert len(scale) == len(set(scale)) == len(levels) - 1
    used = {m["fill"] for m in ink.marks if m.get("pen") == 0.05}
    assert used <= set(scale)
    written = [float(w) for w in words_of(ink) if w.replace(".", "").isdigit()]
    assert written == pytest.approx([level / 1e6 for level in levels])


@pytest.mark.parametrize("name", BOTH)
def test_bands_fill_the_bodies(name):
    """The signed areas of all bands add up to those of the elements: no gap, no overlap."""

    def signed(rings):
        found = 0.0
        for ring in rings:
            pairs = zip(ring, [*ring[1:], ring[0]], strict=True)
            found += sum(a[0] * b[1] - b[0] * a[1] for a, b in pairs) / 2
        return found

    one = solved(name)
    for contact in one.elements:
        field = contact.field
        a, b, c = (field.nodes[field.triangles[:, k]] for k in range(3))
        turn = (b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]
        parts = [signed(rings) for rings in bands_of(field, drawn.stress_levels(one))]
        assert min(parts) >= -1e-15
        assert sum(parts) == pytest.approx(turn.sum() / 2, rel=1e-9)
        whole = sum(signed(rings) for rings in outlines_of(field))
        assert whole == pytest.approx(turn.sum() / 2, rel=1e-9)


def test_a_band_ends_where_the_stress_meets_its_level():
    """Two triangles at stress 1 beside two at 3: by hand the level 2 is their common edge."""
    nodes = np.array([[0, 0], [1, 0], [2, 0], [0, 1], [1, 1], [2, 1]], dtype=float)
    triangles = np.array([[0, 1, 4], [0, 4, 3], [1, 2, 5], [1, 5, 4]])
    field = StressField(nodes, triangles, np.array([1.0, 1.0, 3.0, 3.0]), np.zeros(4, int))
    # corners (1,0) and (1,1): means of elements 1, 3, 3 and of 1, 1, 3
    assert contours.corner_values(field.nodes, field.triangles, field.von_mises) == pytest.approx(
        [1, 7 / 3, 3, 1, 5 / 3, 3]
    )
    low, high = bands_of(field, [0.0, 2.0, 4.0])
    points = {(round(x, 6), round(y, 6)) for ring in low for x, y in ring}
    # level 2 on the edges: 0-1 at (2-1)/(4/3); 1-4 at (7/3-2)/(2/3); 4-5 at (2-5/3)/(4/3)
    assert {(0.75, 0.0), (1.0, 0.5), (1.25, 1.0)} <= points
    assert sum(map(area, low)) + sum(map(area, high)) == pytest.approx(2.0)
    (ring,) = outlines_of(field)[0]
    assert len(ring) == 6


def test_back_up_rings_take_their_room():
    """Two back-up rings of 1.1 mm leave 2.2 mm less of the groove to the elements."""
    subject = ao.read(TEXTS["rings"]).subject()
    rings = {one.name: one for one in base(subject, subject.values()).rings}
    assert room(rings["piston"]) == pytest.approx(rings["piston"]["groove_width"] - 2.2e-3)
    assert room(rings["rod"]) == pytest.approx(rings["rod"]["groove_width"])


# ---- contact ----


@pytest.mark.parametrize("name", BOTH)
def test_contact_curves_are_those_of_elements_and_closed_form(name):
    """A curve per pressure on equal axes; their highest points are both solutions' peaks."""
    one = solved(name)
    elements, closed = (column[0] for column in seal_figures.elements_panels(one))
    assert (elements.x.range, elements.y.range) == (closed.x.range, closed.y.range)
    ring = one.out.rings[0].ring
    for contact, solution, form in zip(one.elements, elements.curves, closed.curves, strict=True):
        assert solution.words == form.words == text.bars(contact.pressure)
        law = closed_form(ring.at(pressure=contact.pressure))
        profile = float(np.max(law.profile(np.linspace(0, 1, 121)))) / 1e6
        tops = [float(np.max(curve.ys)) for curve in (solution, form)]
        assert tops == pytest.approx([contact.peak_pressure / 1e6, profile], rel=2e-3, abs=2e-3)
        assert max(tops) < elements.y.range[1]
        assert max(solution.xs[-1], form.xs[-1]) <= elements.x.range[1]


@pytest.mark.parametrize("name", BOTH)
def test_circles_are_the_peaks_and_widths(name):
    """Each circle stands at its pressure and the solution's peak or width."""
    one = solved(name)
    values = [[c.peak_pressure / 1e6 for c in one.elements], [1e3 * c.width for c in one.elements]]
    for (_, panel), wanted in zip(seal_figures.elements_panels(one), values, strict=True):
        (circles,) = panel.points
        assert list(circles.xs) == pytest.approx([c.pressure / 1e5 for c in one.elements])
        assert list(circles.ys) == pytest.approx(wanted)


# ---- sheet and terminal ----


@pytest.mark.parametrize("name", BOTH)
def test_figures_stay_small_and_nothing_collides(name):
    """Both stand on the sheet; texts apart, all ink on the paper, each below 300 kB."""
    figures = [b for b in blocks(solved(name)) if "finite elements" in b["title"]]
    assert len(figures) == 2
    for block in figures:
        ink = ink_of(block)
        assert overlaps(ink.text_boxes()) == []
        for _, left, top, right, bottom in ink.text_boxes():
            assert left > -0.01
            assert right < ink.width + 0.5
            assert 0 < top < bottom < ink.height
        points = np.array([p for path in paths(ink) for line in path for p in line])
        assert points.min() >= -0.01
        assert points[:, 0].max() <= ink.width + 0.01
        assert points[:, 1].max() <= ink.height + 0.01
        assert len(json.dumps(block)) < 300_000


@pytest.mark.long
def test_the_notes_say_what_is_left_out():
    """No friction, creep, yielding; of a step ring the edge's peak, and what was not found."""
    stress, contact = (b["note"] for b in blocks(solved("step_ring")) if "finite el" in b["title"])
    for words in ("no friction", "no creep", "no yielding"):
        assert words in stress
    for words in ("depends on the mesh", "Huang2017", "closed form"):
        assert words in contact
    assert "Huang2017" not in seal.contact_note(solved("o_ring"))


def test_without_elements_there_is_neither_figure_nor_line():
    """A study by closed forms has no block of elements and no sentence."""
    one = replace(solved("o_ring"), elements=())
    assert not any("finite elements" in b["title"] for b in blocks(one))
    assert seal.elements_sentence(one) == ""
    assert "finite elements" not in shown(one)
    assert "finite elements" not in str(seal.contact_rows(one))


@pytest.mark.parametrize("width", [60, 100])
def test_the_terminal_names_width_and_peak(width):
    """One sentence with width and peak of the contact, and those of the closed form."""
    one = solved("o_ring")
    lines = shown(one, width=width)
    assert max(map(len, lines.splitlines())) <= width
    said = " ".join(lines.split())
    ring = one.out.rings[0]
    law = closed_form(ring.ring)
    for value in (1e3 * float(law.width), 1e-6 * float(law.peak)):
        assert f"closed form {value:.3g}"[:16] in said
    assert "by finite elements at 210 bar: width" in said
    assert seal.contact_rows(one)[0][-1] == "finite elements"
