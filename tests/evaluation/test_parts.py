"""Ports, spherical bearings and position sensor: masses by hand, limits, refusals, drawings."""

from __future__ import annotations

import io
import re
from itertools import pairwise
from math import pi
from pathlib import Path

import ezdxf
import numpy as np
import pytest
from shipped import PLAIN_KNEE
from step_reader import StepFile

import actuator_opt as ao
from actuator_opt.base.errors import InputError
from actuator_opt.design import standard_sizes
from actuator_opt.design.materials import load_library
from actuator_opt.evaluation.outline_templates import shapes
from actuator_opt.evaluation.parts_list import parts_list
from actuator_opt.exports.dxf import dxf
from actuator_opt.exports.step import bodies, step
from actuator_opt.models import gland, port, spherical_bearing

DESIGNS = Path(__file__).parents[2] / "designs"
BORE, LINER, WINDING, ROD, ROD_BORE = 21.8e-3, 1.85e-3, 2.65e-3, 12e-3, 8e-3
"""Sizes in `PLAIN_KNEE` [m]: bore, layers of the barrel, and both diameters of the rod."""
OUTER = BORE / 2 + LINER + WINDING
PUSH = 21e6 * pi / 4 * BORE**2
"""Supply pressure on the piston of the knee [N]."""
NUT = r"  nut:.*\n(    .*\n)+"
SENSOR = """sensor:
  type: magnetostrictive
  diameter: 6 mm
  dead_length: 15 mm
  mass: 40 g

"""


def near(value, rel=1e-9):
    """Equal up to rounding."""
    return pytest.approx(value, rel=rel)


def text_of(name, *changes):
    """A shipped design, changed by (pattern, text); every pattern occurs."""
    text = PLAIN_KNEE if name == "knee" else (DESIGNS / f"{name}.yaml").read_text("utf-8")
    for pattern, new in changes:
        assert re.search(pattern, text)
        text = re.sub(pattern, new, text, count=1)
    return text


PORTS = (r"  port_diameter: 6 mm\n", "  port_thread: m8x1\n")
BEARINGS = (r"  pin_diameter: 8 mm\n", "  bearing: ge8e\n")
NECK = (BEARINGS[0], "  bearing: ge8e\n  neck: 20 mm\n")
LONGER = (r"length: 12.5 mm", "length: 15 mm")


def pair(name, *changes, before=()):
    """A design with some changes, and with these and `changes`."""
    return (
        ao.evaluate(ao.read(text_of(name, *before))),
        ao.evaluate(ao.read(text_of(name, *before, *changes))),
    )


def difference(first, second):
    """Change of each part's mass."""
    parts = {**first.mass_parts, **second.mass_parts}
    return {
        part: second.mass_parts.get(part, 0.0) - first.mass_parts.get(part, 0.0) for part in parts
    }


LIBRARY = load_library()


def density(name):
    """Density of a material of the library."""
    return LIBRARY.get(name).numbers["density"]


def test_the_tables_are_plausible_and_say_what_was_checked():
    """Bore below core of the thread, seat and boss around it; ratings rise with the size."""
    tables = standard_sizes.tables()
    ports = [standard_sizes.port(name) for name in tables.names("ports")]
    assert len(ports) == 25
    for size in ports:
        assert size.bore < size.diameter - 1.08 * size.pitch < size.diameter < size.seat < size.boss
        assert size.depth < size.drilled
        assert size.confidence == "unverified"
    bearings = [standard_sizes.spherical_bearing(n) for n in tables.names("spherical_bearings")]
    assert len(bearings) == 19
    for size, larger in pairwise(bearings):
        assert size.name == f"ge{1e3 * size.bore:g}e"
        assert (size.bore, size.static_rating) < (larger.bore, larger.static_rating)
        # steel of the ring space, and less: the gap between the rings and the grease weigh little
        ring = 7850 * pi / 4 * (size.outer_diameter**2 - size.bore**2) * size.width
        assert 0.5 * ring < size.mass < 1.02 * ring


def test_saddle_of_a_boss_by_quadrature():
    """Mean of R - sqrt(R^2 - y^2) over the disc."""
    radius = 15e-3
    for half in (3e-3, 7e-3, 12e-3):
        offset = np.linspace(-half, half, 400001)
        weight = np.sqrt(half**2 - offset**2)
        mean = np.sum(weight * (radius - np.sqrt(radius**2 - offset**2))) / np.sum(weight)
        found = port.saddle_depth(boss_diameter=2 * half, tube_radius=radius)
        assert found == pytest.approx(mean, rel=3e-3)
        volume = port.boss_volume(boss_diameter=2 * half, height=0.01, tube_radius=radius)
        assert volume == near(pi * half**2 * (0.01 + found))


def test_bosses_on_the_barrel_by_hand():
    """A barrel that encloses its plugs: two bosses, without thread, and two holes in the wall."""
    bare, found = pair("knee", PORTS, before=[LONGER])
    boss, depth, pitch_diameter, bore = 14e-3, 11.5e-3, (8 - 0.649519) * 1e-3, 3e-3
    solid = port.boss_volume(boss_diameter=boss, height=depth, tube_radius=OUTER)
    metal, fibres = density("al_7075_t6"), density("t700_epoxy")
    one = metal * (solid - pi / 4 * pitch_diameter**2 * depth)
    wall = pi / 4 * bore**2 * (metal * LINER + fibres * WINDING)
    change = difference(bare, found)
    assert change.pop("ports") == near(2 * one, 1e-5)
    assert change.pop("barrel") == near(-2 * wall, 1e-6)
    assert set(change.values()) == {0.0}
    assert "ports and fittings" in bare.mass_leaves_out
    assert "ports and fittings" not in found.mass_leaves_out
    assert "fittings of the ports" in found.mass_leaves_out
    assert {"port"} == {value.material for value in found.unverified if value.value == "m8x1"}


def test_ports_in_the_plates_by_hand():
    """Skirted caps: a hole in each rim, a drilling to the chamber, a boss on the head."""
    thick = (r"(caps:\n(?:  .*\n)*?  thickness:) .*", r"\1 12 mm")
    bare, found = pair("steel_baseline", PORTS, before=[thick])
    g = {name: float(value) for name, value in found.lengths.items()}
    change, design = difference(bare, found), found.design
    steel = density(design.caps.material)
    area, depth = pi / 4 * 3e-3**2, 11.5e-3
    cut = pi / 4 * ((8 - 0.649519) * 1e-3) ** 2 * depth
    plate, rod = g["plate_outer"] / 2, g["rod"] / 2
    rim = max(depth - (plate - rod - design.head.clearance - 1e-3), 0.0)
    assert rim > 0
    groove = design.seals.rod
    inner = rod + groove.section * (1 - groove.squeeze)
    outer = g["bore"] / 2 - design.seals.static.section * (1 - design.seals.static.squeeze)
    axis = (inner + outer) / 2
    further = [max(plate + more - depth - axis, 0.0) for more in (0.0, rim)]
    boss = pi / 4 * 14e-3**2 * rim
    caps = boss - 2 * cut - area * (sum(further) + 12e-3)
    assert change.pop("caps") == near(steel * caps, 1e-5)
    head = density(design.head.material)
    assert change.pop("glands") == near(-head * area * design.head.length)
    assert set(change.values()) == {0.0}
    drilled = max(3e-3**2 / (4 * axis), 1e-3)  # drillings over half the circumference
    rows = {"plate": (12e-3 - 9.1e-3) / 2, "head": (outer - inner - drilled) / 2}
    assert found.metrics["geometry_port"].value == near(min(rows.values()))


def test_limits_of_the_bosses_by_hand():
    """The land of the piston and the barrel beside the boss; a thin barrel misses the limit."""
    _, found = pair("knee", PORTS, before=[LONGER])
    seal = found.design.seals.piston
    width = gland.back_up_groove_width(
        groove_width=gland.groove_width(section=seal.section),
        thickness=seal.back_up_thickness,
        count=2,
    )
    land = (15e-3 - width) / 2
    assert found.metrics["geometry_port"].value == near(land - 3e-3)
    large = ao.evaluate(ao.read(text_of("knee", LONGER, (PORTS[0], "  port_thread: g1_2\n"))))
    row = large.metrics["geometry_port"]
    assert row.place == "land of the piston beyond the port"
    assert row.value == near(land - 14e-3)


def test_bosses_sit_on_the_winding_over_a_sleeve():
    """A sleeve of 2.4 mm lifts the winding by 0.55 mm; the bare 7 mm at its end carry no boss."""
    sleeve = "  sleeve:\n    material: al_7075_t6\n    wall: 2.4 mm\n    inner_length: 25 mm\n"
    text = text_of("knee", LONGER, PORTS, (r"    pitch: 0.75 mm\n", rf"\g<0>{sleeve}"))
    design = ao.read(text.partition("\nvariables:")[0])
    found = ao.evaluate(design)
    parts = {outline.part: outline for outline in found.outlines}
    radii = [r for polygon in parts["port bosses"].polygons for _, r in polygon]
    assert [min(radii), max(radii)] == near([OUTER + 0.55e-3, OUTER + 0.55e-3 + 11.5e-3])
    row = found.metrics["geometry_port"]
    assert row.place == "barrel's end beside the boss, cap"
    assert row.value == near(4.7e-3 + 3e-3 / 2 - 14e-3 / 2)  # plate, axis of the port, half a boss
    walls = {"retention.sleeve.wall": np.array([2.4e-3, 2.6e-3])}
    drawn = shapes(design.subject(), walls, 2)
    assert list(drawn.which) == [0, 0]
    (template,) = drawn.templates
    x_and_r = template.at(drawn.dimensions)[:-4].reshape(-1, 2, 2)
    assert x_and_r[:, 1].max(axis=0) == near(OUTER + np.array([0.55e-3, 0.75e-3]) + 11.5e-3, 1e-7)


def test_bearings_by_hand():
    """Eyes with GE8E: lug, neck and bearing; static load rating over push; length of the eyes."""
    bare, found = pair("knee", BEARINGS)
    d, outer, width = 8e-3, 16e-3, 8e-3
    radius = outer / 2 + d**2 / (2 * width)
    assert radius == near(12e-3)
    sizes = {"pin_diameter": d, "outer_diameter": outer, "width": width}
    assert spherical_bearing.lug_radius(**sizes) == near(radius)
    volume = pi * width * (radius**2 - outer**2 / 4) + pi / 4 * d**3
    assert spherical_bearing.bearing_eye_volume(**sizes) == near(volume)
    steel = density("steel_42crmo4")
    assert bare.mass_parts["clevises"] == near(2 * steel * pi * d**3)
    assert found.mass_parts["clevises"] == near(2 * (steel * volume + 8e-3))
    assert found.metrics["eye_bearing_factor"].value == near(27.5e3 / PUSH)
    longer = found.metrics["closed_length"].value - bare.metrics["closed_length"].value
    assert longer == near(2 * (radius + d - 2 * d))
    assert found.metrics["pin_factor"].value == bare.metrics["pin_factor"].value
    assert "spherical bearings of the eyes" in bare.mass_leaves_out
    assert "spherical bearings of the eyes" not in found.mass_leaves_out


def test_a_choice_of_bearings_is_judged_by_their_ratings():
    """GE4E misses the factor 1.5 of the check list, GE5E meets it, and larger ones weigh more."""
    rows = []
    text = text_of("knee", BEARINGS) + "choices:\n  clevis.bearing: [ge4e, ge5e, ge8e]\n"
    for name, rating in (("ge4e", 10.2e3), ("ge5e", 17e3), ("ge8e", 27.5e3)):
        found = ao.evaluate(ao.read(text, set={"clevis.bearing": name}))
        (check,) = [c for c in found.checks if c.metric == "eye_bearing_factor"]
        assert check.value == near(rating / PUSH)
        rows.append((found.metrics["mass"].value, check.status))
    assert [status for _, status in rows] == ["missed", "met", "met"]
    assert rows == sorted(rows, key=lambda row: row[0])


def test_sensor_by_hand():
    """The sensor adds its mass, and takes the piston's core and one plug of the rod away."""
    hollow = (r"  inner_diameter: \S+ mm", "  inner_diameter: 8.5 mm")
    before = [(NUT, ""), hollow]
    bare, found = pair("knee", (r"clevis:\n", SENSOR + "clevis:\n"), before=before)
    area = pi / 4 * 8.5e-3**2
    change = difference(bare, found)
    assert change.pop("sensor") == near(40e-3)
    assert change.pop("piston") == near(-density("al_7075_t6") * area * 12.5e-3)
    assert change.pop("fastening") == near(-density("steel_42crmo4") * area * 10e-3)
    assert set(change.values()) == {0.0}
    inside = 12.5e-3 + (110 + 8 + 4.7 + 12) * 1e-3 - 10e-3  # piston and rod, without the plug
    rows = (8.5e-3 - 6e-3) / 2, inside - 110e-3 - 15e-3
    assert found.metrics["geometry_sensor"].value == near(min(rows))
    assert "position sensor" not in found.mass_leaves_out


REFUSED = [
    ([(PORTS[0], "  port_diameter: 6 mm\n  port_thread: m8x1\n")],
     r"port_diameter: 6 mm: larger than the bore of a port M8x1 \(3 mm\); write at most 3 mm"),
    ([(PORTS[0], "  port_thread: m9\n")], r"port_thread: \"m9\".*use one of|port_thread: \"m9\""),
    ([(BEARINGS[0], "  pin_diameter: 8 mm\n  bearing: ge10e\n")],
     r"pin_diameter: 8 mm: the bore of bearing ge10e is 10 mm; remove the line"),
    ([(BEARINGS[0], "")], r"clevis.pin_diameter: missing: required without bearing; add e.g."),
    ([(r"clevis:\n", SENSOR + "clevis:\n")], r"sensor: the sensor would pass through the stud"),
    ([(NUT, ""), (r"  inner_diameter: 8 mm\n", ""), (r"  rod.inner_diameter:\n(    .*\n)+", ""),
      (r"clevis:\n", SENSOR + "clevis:\n")],
     r"sensor.diameter: 6 mm: needs a rod with a bore of 8 mm, but it is solid; write"),
]  # fmt: skip


@pytest.mark.parametrize(("changes", "words"), REFUSED)
def test_contradictions_are_refused_in_one_line(changes, words):
    """Bore larger than the port's, a pin that is not the bearing's, a solid rod, a solid stud."""
    with pytest.raises(InputError, match=words) as caught:
        ao.read(text_of("knee", *changes))
    assert len(caught.value.diagnostics) == 1


def test_drawings_show_ports_bearings_and_sensor():
    """Ports above the axis only; STEP has a closed body for each boss; DXF is valid."""
    hollow = (r"  inner_diameter: \S+ mm", "  inner_diameter: 8.5 mm")
    sensor = (r"clevis:\n", SENSOR + "clevis:\n")
    changes = [LONGER, (NUT, ""), hollow, PORTS, BEARINGS, sensor]
    found = ao.evaluate(ao.read(text_of("knee", *changes)))
    parts = {outline.part: outline for outline in found.outlines}
    assert {"ports", "port bosses", "eye bearings", "sensor"} <= set(parts)
    assert {part for part, outline in parts.items() if outline.radial} == {"ports", "port bosses"}
    assert parts["ports"].material == "M8x1, ISO 6149-1"
    top = max(r for polygon in parts["port bosses"].polygons for _, r in polygon)
    assert top == near(OUTER + 11.5e-3)
    assert [body.axes for body in bodies(found) if body.axes] == 2 * [((0.0, 1.0, 0.0),)]
    StepFile(step(bodies(found), name="knee", program="test"))
    document = ezdxf.read(io.StringIO(dxf(found, program="test").decode()))
    assert not document.audit().errors
    layers = {entity.dxf.layer for entity in document.modelspace()}
    assert {"ports", "port bosses", "eye bearings", "sensor"} <= layers


def test_the_parts_list_counts_pieces_and_names_materials():
    """Every entry of the mass breakdown, with pieces and materials; DXF and report have them."""
    found = ao.evaluate(ao.read(text_of("knee", LONGER, PORTS, BEARINGS)))
    rows = {row.part: row for row in parts_list(found)}
    assert {part: row.mass for part, row in rows.items()} == dict(found.mass_parts)
    assert rows["barrel"][1:3] == (1, "al_7075_t6, t700_epoxy")
    assert rows["caps"][1:3] == (2, "al_7075_t6")
    # piston: ring and two back-ups; rod: ring and one back-up; a static ring in cap and in head
    assert rows["seals"][1:3] == (3 + 2 + 2, "nbr_90, back_up_ptfe")
    assert rows["fastening"][1:3] == (None, "steel_42crmo4")
    assert rows["clevises"][1:3] == (2, "steel_42crmo4 with GE8E, ISO 12240-1")
    assert rows["ports"][1:3] == (2, "al_7075_t6, M8x1, ISO 6149-1")
    bonded = ao.evaluate(ao.read(DESIGNS / "knee_bonded.yaml"))
    (caps,) = [row for row in parts_list(bonded) if row.part == "caps"]
    assert caps.material == "al_7075_t6, epoxy_structural"
    document = ezdxf.read(io.StringIO(dxf(found, program="test").decode()))
    texts = [entity.dxf.text for entity in document.modelspace().query("TEXT")]
    mass = 1e3 * found.mass_parts["ports"]
    assert f"2 ports, {mass:.4g} g, al_7075_t6, M8x1, ISO 6149-1" in texts
    assert any("M8x1 by ISO 6149-1, full thread 10 deep, drill 11.5 deep" in t for t in texts)
    assert "Holes of the eyes: 16 mm for GE8E." in texts
    assert "Thread of the piston's stud: M8 x 1 - 6g; tighten to 8 kN." in texts


CUSHION = """cushion:
  diameter: 15 mm
  length: 10 mm
  open_area: 20 mm^2
  end_area: 1 mm^2

"""
CUSHIONED = (r"clevis:\n", CUSHION + "clevis:\n")


def test_cushions_by_hand():
    """Two bushes lengthen barrel and rod; spear and collar are of the rod's steel, and move."""
    bare, found = pair("knee", CUSHIONED)
    d, length = 15e-3, 10e-3
    metal, fibres, steel = (density(n) for n in ("al_7075_t6", "t700_epoxy", "steel_42crmo4"))
    inner = pi * ((BORE / 2 + LINER) ** 2 - BORE**2 / 4)
    outer = pi * (OUTER**2 - (BORE / 2 + LINER) ** 2)
    change = difference(bare, found)
    assert change.pop("barrel") == near(2 * length * (metal * inner + fibres * outer), 1e-6)
    bush = metal * pi / 4 * (BORE**2 - d**2) * length
    assert change.pop("caps") == near(bush)
    assert change.pop("glands") == near(bush)
    assert change.pop("rod") == near(steel * pi / 4 * (ROD**2 - ROD_BORE**2) * length)
    spear, collar = pi / 4 * d**2 * length, pi / 4 * (d**2 - ROD**2) * length
    assert change.pop("fastening") == near(steel * (spear + collar))
    assert max(map(abs, change.values())) < 1e-12
    for name in ("closed_length", "barrel_length"):
        assert found.metrics[name].value - bare.metrics[name].value == near(2 * length)
    assert found.metrics["geometry_cushion"].value == near((d - ROD) / 2)
    assert found.metrics["buckling_factor"].value < bare.metrics["buckling_factor"].value
    alone = ao.evaluate(ao.read(text_of("knee", CUSHIONED), set={"cushion.ends": "cap"}))
    longer = alone.metrics["closed_length"].value - bare.metrics["closed_length"].value
    assert longer == near(length)
    assert alone.metrics["geometry_cushion"].value == near((BORE - d) / 2)
    assert alone.mass_parts["rod"] == near(bare.mass_parts["rod"])


def test_a_port_opens_into_the_bush_of_a_cushion():
    """The piston then passes no port, so that its land sets no limit."""
    found = ao.evaluate(ao.read(text_of("knee", PORTS, CUSHIONED)))
    parts = {outline.part: outline for outline in found.outlines}
    (bush,) = [p for p in parts["caps"].polygons if max(r for _, r in p) == near(BORE / 2)][-1:]
    middle = (min(x for x, _ in bush) + max(x for x, _ in bush)) / 2
    thread = parts["ports"].polygons[0]
    assert (min(x for x, _ in thread) + max(x for x, _ in thread)) / 2 == near(middle)
    assert found.metrics["geometry_port"].place == "barrel beside the boss"
    assert found.metrics["geometry_port"].value == near(OUTER - 7e-3)


MANIFOLD = """extra_masses:
  - kind: manifold
    mass: 120 g
    place: cap
    length: 25 mm
  - kind: other
    mass: 4 g
    count: 2
    place: head
  - kind: other
    mass: 10 g
    place: rod
    length: 3 mm
    count: 2

clevis:
"""


def test_a_linkage_knows_the_length_of_cushions_bearings_neck_and_components():
    """The fault of a dead point names the closed length that the evaluation has."""
    linkage = "linkage:\n  base_radius: 20 mm\n  crank_radius: 300 mm\n\nclevis:\n"
    changes = [NECK, CUSHIONED, (r"clevis:\n", MANIFOLD)]
    length = ao.evaluate(ao.read(text_of("knee", *changes))).metrics["closed_length"].value
    with pytest.raises(InputError, match=f"the actuator, {1e3 * length:.4g} mm to"):
        ao.read(text_of("knee", *changes, (r"clevis:\n", linkage)))


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("length: 10 mm", "length: 120 mm", r"cushion.length: 120 mm: must be smaller than"),
        ("end_area: 1 mm^2", "end_area: 30 mm^2", r"cushion.end_area: .* below open_area"),
        ("end_area: 1 mm^2", "end_area: 0 mm^2", r"cushion.end_area: .* must be above 0"),
    ],
)
def test_contradictions_of_a_cushion_are_refused_in_one_line(old, new, words):
    """Longer than the stroke, a gap that does not close, a gap that closes fully."""
    with pytest.raises(InputError, match=words) as caught:
        ao.read(text_of("knee", (r"clevis:\n", CUSHION.replace(old, new) + "clevis:\n")))
    assert len(caught.value.diagnostics) == 1


def test_a_scenario_takes_the_cushions_of_its_design(tmp_path):
    """The same force over time as with the same cushion in the scenario."""
    design = text_of("servo_knee", (r"(?m)^clevis:\n", CUSHION.replace("15", "18") + "clevis:\n"))
    (tmp_path / "with.yaml").write_text(design)
    body = "duration: 0.35 s\nsample_time: 1 ms\ninitial:\n  position: 30 mm\n"
    body += "signal:\n  - shape: constant\n    value: -10 V\n"
    stop = "".join(f"    {line}\n" for line in CUSHION.splitlines()[2:5])
    forces = []
    for extra in ("", f"stops:\n  cushion:\n{stop}"):
        path = tmp_path / "scenario.yaml"
        path.write_text(f"name: stop\ndesign: with.yaml\n{body}{extra}")
        forces.append(ao.simulate(path).signals["cushion_force"])
    np.testing.assert_allclose(forces[0], forces[1], rtol=1e-9, atol=1e-6)
    assert np.max(np.abs(forces[0])) > 100.0


def test_neck_bearing_and_components_lengthen_the_cap_eye_together():
    """Pin, 20 mm of bearing eye, 25 mm of manifold, 20 mm of neck, then the cap; as in DXF."""
    bare, found = pair("knee", NECK, (r"clevis:\n", MANIFOLD))
    eye = 12e-3 + 8e-3  # radius of the lug, by test_bearings_by_hand, and neck as long as the pin
    longer = found.metrics["closed_length"].value - bare.metrics["closed_length"].value
    assert longer == near(2 * (eye - 2 * 8e-3) + 20e-3 + 25e-3 + 2 * 3e-3)
    volume = spherical_bearing.bearing_eye_volume(
        pin_diameter=8e-3, outer_diameter=16e-3, width=8e-3
    )
    steel = density("steel_42crmo4")
    clevises = 2 * (steel * volume + 8e-3) + steel * pi / 4 * 8e-3**2 * 20e-3
    assert found.mass_parts["clevises"] == near(clevises)
    parts = {outline.part: outline for outline in found.outlines}
    ends = {
        name: [f(x for x, _ in polygon) for f in (min, max)]
        for name, polygon in (
            ("neck", parts["cap eye"].polygons[-1]),
            ("manifold", parts["components"].polygons[0]),
            ("cap", parts["caps"].polygons[0]),
        )
    }
    assert ends["manifold"] == near([eye, eye + 25e-3])
    assert ends["neck"] == near([eye + 25e-3, eye + 45e-3])
    assert ends["cap"][0] == near(eye + 45e-3)
    alone = ao.evaluate(ao.read(text_of("knee", NECK)))
    for drawn, right in ((found, [8.0, 20.0, 65.0]), (alone, [8.0, 40.0])):  # hole, eye, neck
        document = ezdxf.read(io.StringIO(dxf(drawn, program="test").decode()))
        lines = document.modelspace().query('LWPOLYLINE[layer=="cap eye"]')
        assert sorted(max(x for x, *_ in line) for line in lines) == near(right)


def test_stated_components_have_count_and_length():
    """Masses times pieces; lengths lie between cap or rod and eye, and weaken the column."""
    bare, found = pair("knee", (r"clevis:\n", MANIFOLD))
    change = difference(bare, found)
    assert change.pop("components") == near(120e-3 + 2 * 4e-3)
    assert change.pop("moving components") == near(20e-3)
    assert set(change.values()) == {0.0}
    longer = found.metrics["closed_length"].value - bare.metrics["closed_length"].value
    assert longer == near(25e-3 + 2 * 3e-3)
    assert found.metrics["buckling_factor"].value < bare.metrics["buckling_factor"].value
    assert "valve and manifold" not in found.mass_leaves_out
    rows = {row.part: row for row in parts_list(found)}
    assert rows["components"][1:3] == (3, "valve and manifold, other")
    parts = {outline.part: outline for outline in found.outlines}
    spans = [[x for x, _ in polygon] for polygon in parts["components"].polygons]
    assert [max(span) - min(span) for span in spans] == [near(25e-3), near(6e-3)]
    ends = [x for x, _ in parts["rod eye"].polygons[0]]
    assert (min(ends) + max(ends)) / 2 == near(found.lengths["closed_length"])
    dxf(found, program="test")
    with pytest.raises(InputError, match=r"extra_masses\[0\].length: only a component between"):
        ao.read(text_of("knee", (r"clevis:\n", MANIFOLD.replace("place: cap", "place: barrel"))))
