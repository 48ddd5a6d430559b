"""STEP files: valid solids, volumes of the mass model, places of the section drawing."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import pytest
from cli_runner import DESIGNS, bench, block
from hypothesis import given, strategies as st
from shipped import evaluated
from step_reader import StepFile, volume

import actuator_opt as ao
from actuator_opt.exports.step import SolidBody, bodies, bounds_solid, joined, step, tidy

SHIPPED = sorted(DESIGNS.glob("*.yaml"))
USUAL = (
    "aerospace", "course_cylinder", "knee", "knee_bonded", "knee_choices", "servo_test_rig",
    "steel_baseline",
)  # fmt: skip
"""Designs that between them have every joint, wall and mount."""
EACH = [
    pytest.param(path, marks=[] if path.stem in USUAL else [pytest.mark.long]) for path in SHIPPED
]
"""All designs."""

FITTED_ROD = """\
rod:
  material: ti_6al4v
  layup:
    - material: t700_epoxy
      angle: 10 deg
      thickness: 1.5 mm
    - material: t700_epoxy
      angle: 80 deg
      thickness: 0.5 mm
  outer_diameter: 14 mm
  extension: 12 mm
  fitting:
    length: 20 mm
    wall: 1.5 mm
    adhesive: epoxy_structural
"""


def exported(design):
    """Evaluation, densities and the file read back, with the numbers the parser saw."""
    actuator = design if isinstance(design, ao.Actuator) else ao.read(design)
    evaluation = evaluated(design.stem) if isinstance(design, Path) else ao.evaluate(actuator)
    densities = {n: m.numbers["density"] for n, m in actuator.subject().materials.items()
                 if "density" in m.numbers}  # fmt: skip
    text = step(bodies(evaluation), name=evaluation.name, program="test")
    return evaluation, densities, StepFile(text)


def masses(evaluation, densities, read):
    """Kg of every part of the outlines, from the volumes read back and how often each is there."""
    count = {}
    for name, _ in read.occurrences():
        count[name] = count.get(name, 0) + 1
    found = {}
    solids = read.solids()
    assert set(solids) == set(count)
    for body in bodies(evaluation):
        mass = count[body.name] * volume(solids[body.name]) * 1e-9 * densities[body.material]
        found[body.part] = found.get(body.part, 0.0) + mass
    return found


def check_masses(evaluation, densities, read):
    """Every fully turned group weighs what the mass model says."""
    found = masses(evaluation, densities, read)
    groups = {
        "barrel": sum(v for k, v in found.items() if k.startswith("layup") or k == "sleeves"),
        "rod": sum(v for k, v in found.items() if k == "rod" or k.startswith("rod.layup")),
        "piston": found["piston"],
        "caps": found["caps"],
        "glands": found["glands"],
    }
    for name, mass in groups.items():
        assert mass == pytest.approx(evaluation.mass_parts[name], rel=1e-9), name
    return found


@pytest.mark.parametrize("path", EACH, ids=lambda path: path.stem)
def test_shipped_designs_weigh_what_the_mass_model_says(path):
    """Closed shells, every edge used once each way, volumes by the divergence theorem."""
    evaluation, densities, read = exported(path)
    check_masses(evaluation, densities, read)


def test_a_second_rod_and_its_gland_are_bodies():
    """The double-rod rig has both rods and both glands, and the second rod starts at x = 0."""
    evaluation, densities, read = exported(DESIGNS / "servo_test_rig.yaml")
    places = dict(read.occurrences())
    assert {"rod", "second_rod", "head, cap end", "head, rod end", "cap, cap end"} <= set(places)
    assert places["second_rod"][0] == pytest.approx(0.0, abs=1e-9)
    found = masses(evaluation, densities, read)
    assert found["second rod"] == pytest.approx(evaluation.mass_parts["second rod"], rel=1e-9)


def test_places_are_those_of_the_section():
    """Each solid, put where the assembly says, covers what the outline covers."""
    evaluation, _, read = exported(DESIGNS / "knee_bonded.yaml")
    solids, places = read.solids(), dict(read.occurrences())
    lengths = {name: 1000 * value for name, value in evaluation.lengths.items()}
    start = lengths["eye_offset"] + lengths["plate"]
    ends = {
        "cap, cap end": lengths["eye_offset"],
        "piston": start,
        "rod": start + lengths["piston_length"],
        "head": start + lengths["barrel_length"] - lengths["head_length"],
        "barrel.layup[2]": start,
    }
    for name, x in ends.items():
        assert places[name] == pytest.approx((x, 0.0, 0.0), abs=1e-9)
        assert min(face.start[0] for face in solids[name]) == 0.0
    tip = max(face.end[0] for face in solids["rod"]) + places["rod"][0]
    assert tip == pytest.approx(lengths["closed_length"] - lengths["eye_offset"], abs=1e-9)
    radii = {face.start[1] for face in solids["barrel.layup[2]"] if face.kind[0] == "C"}
    assert max(radii) == pytest.approx(lengths["barrel_outer_diameter"] / 2, abs=1e-9)


def test_tie_rods_stand_around_the_barrel():
    """Bars of the stated diameter through plates and a hexagon nut at each end, evenly spread."""
    evaluation, densities, read = exported(DESIGNS / "aerospace.yaml")
    found = check_masses(evaluation, densities, read)
    bolt, length = 5e-3, evaluation.lengths["barrel_length"] + 2 * evaluation.lengths["plate"]
    nuts = 2 * math.sqrt(3) / 2 * (1.5 * bolt) ** 2 * 0.8 * bolt  # with the thread in them
    count = evaluation.design.retention.count
    by_hand = count * (math.pi / 4 * bolt**2 * length + nuts) * densities["steel_bolt_12_9"]
    assert found["tie rods"] == pytest.approx(by_hand, rel=1e-9)
    places = [place for name, place in read.occurrences() if name == "tie rod"]
    ring = 1000 * (evaluation.lengths["barrel_outer_diameter"] / 2 + bolt)
    turns = sorted(math.atan2(z, y) % math.tau for _, y, z in places)
    assert [math.hypot(y, z) for _, y, z in places] == pytest.approx([ring] * round(count))
    assert turns == pytest.approx([k * math.tau / count for k in range(round(count))], abs=1e-9)


def test_radial_pins_go_through_the_plies():
    """Two rows of pins: each pin starts in the plug, points outwards, and ends at the outside."""
    text = (DESIGNS / "knee.yaml").read_text("utf-8").partition("\nvariables:")[0] + "\n"
    layup = text[text.index("  layup:") : text.index("\nrod:")]
    retention = text[text.index("retention:\n") : text.index("\nclevis:")]
    plies = "".join(
        f"    - {{material: t700_epoxy, angle: {angle} deg, thickness: {thickness} mm}}\n"
        for angle, thickness in ((88, 1.4), (45, 1.6), (0, 0.5))
    )
    liner = "  layup:\n    - {material: al_7075_t6, thickness: 1.6 mm}\n"
    pins = (
        "retention:\n  type: pins\n  material: steel_bolt_12_9\n  length: 26 mm\n  wall: 6 mm\n"
        "  count: 7\n  rows: 2\n  diameter: 3.6 mm\n  spacing: 11 mm\n  edge: 11 mm\n"
    )
    text = text.replace(layup, liner + plies).replace(retention, pins)
    evaluation, _, read = exported(ao.read(text))
    solids = read.solids()
    names = [f"pin, row {row}" for row in range(1, 5)]
    by_hand = math.pi / 4 * 3.6**2 * (6 + 3.5)
    assert [volume(solids[name]) for name in names] == pytest.approx([by_hand] * 4, rel=1e-9)
    outer = 1000 * evaluation.lengths["barrel_outer_diameter"] / 2
    face, end = 1000 * evaluation.lengths["eye_offset"], []
    for name, (x, y, z), axis in read.placed():
        if name in names:
            low = math.hypot(y, z)
            assert low == pytest.approx(outer - 9.5)
            assert axis == pytest.approx((0.0, y / low, z / low), abs=1e-9)
            end.append(x)
    assert len(end) == 28
    assert sorted(set(end))[:2] == pytest.approx([face - 15.0, face - 4.0])


def test_a_rod_of_layers_with_fittings():
    """Every layer is a solid, and so are the two sleeves; the plugs have no place and stay out."""
    evaluation, densities, read = exported(ao.read(bench((block("rod"), FITTED_ROD))))
    found = check_masses(evaluation, densities, read)
    hole = 2 * (7.0 - 2.0 - 1.5)
    sleeves = 2 * math.pi / 4 * (10.0**2 - hole**2) * 20.0 * 1e-9 * densities["ti_6al4v"]
    assert found["rod.fitting"] == pytest.approx(sleeves, rel=1e-9)
    names = [name for name, _ in read.occurrences()]
    assert {"rod.fitting, piston end", "rod.fitting, rod end"} <= set(names)


FREE_WALL = "  retention.wall:\n    lower: 1 mm\n    upper: 10 mm\n"
FREE_LAYER = "  barrel.layup[1].thickness:\n    lower: 0.5 mm\n    upper: 4 mm\n"
STEEL = "barrel:\n  layup:\n    - material: steel_e355\n      thickness: 3 mm\n"
LINKAGE = "linkage:\n  base_radius: 202.4 mm\n  crank_radius: 151.8 mm\n\nload:\n"
VARIANTS = {
    "default caps": ((block("caps"), ""),),
    "no clevis": ((block("clevis"), ""), ("cap_clevis", "cap_flange")),
    "no retention": ((block("retention"), ""), (FREE_WALL, "")),
    "metal barrel": ((block("barrel"), STEEL), (FREE_LAYER, "")),
    "solid rod": (("  inner_diameter: 7 mm\n", "  inner_diameter: 0 mm\n"),),
    "plunger": (("seals:\n  piston:\n", "seals:\n  piston:\n    count: 0\n"),),
    "two rings": (("seals:\n  piston:\n", "seals:\n  piston:\n    count: 2\n"),),
    "longer barrel": (("barrel:\n  layup", "barrel:\n  length: 180 mm\n  layup"),),
    "linkage": (("load:\n", LINKAGE), ("    force: 4 kN", "    joint_torque: 200 N*m")),
    "film": (("    friction_coefficient: 0.10\n  rod:", "    friction: film\n  rod:"),),
}


@pytest.mark.parametrize("name", VARIANTS)
def test_every_kind_of_design_exports(name):
    """Volumes hold whatever the design has or lacks."""
    evaluation, densities, read = exported(ao.read(bench(*VARIANTS[name])))
    check_masses(evaluation, densities, read)


def test_names_survive():
    """Quotes, backslashes and letters beyond ASCII come back as ISO 10303-21 writes them."""
    box = ((0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0))
    made = step(
        [SolidBody("a 'b' \\ ö 管 😀", "p", "m", box, ((0.0, 0.0, 0.0),))], name="n", program="p"
    )
    (name,) = StepFile(made).solids()
    words = r"a ''b'' \\ \X2\00F6\X0\ \X2\7BA1\X0\ \X4\0001F600\X0" + "\\"
    assert name == words


CONES = {
    "tip ahead": (((0, 0), (5, 0), (0, 2)), math.pi * 4 * 5 / 3),
    "tip behind": (((0, 0), (3, 0), (3, 2)), math.pi * 4 * 3 / 3),
    "bored frustum": (((0, 1), (5, 1), (5, 4), (0, 2)), math.pi * (5 / 3 * (4 + 8 + 16) - 5)),
    "conical bore": (((0, 1), (6, 3), (6, 4), (0, 4)), math.pi * (96 - 6 / 3 * (1 + 3 + 9))),
    "diamond": (((0, 3), (1, 2), (2, 3), (1, 4)), 2 * math.pi * 3 * 2),  # Pappus
}


@pytest.mark.parametrize("name", CONES)
def test_cones(name):
    """Frustums by h/3 (a^2 + ab + b^2), a ring by Pappus."""
    profile, by_hand = CONES[name]
    profile = tuple((float(x), float(r)) for x, r in profile)
    assert bounds_solid(profile)
    (faces,) = (
        StepFile(
            step([SolidBody("c", "c", "m", profile, ((0.0, 0.0, 0.0),))], name="c", program="p")
        )
        .solids()
        .values()
    )
    assert volume(faces) == pytest.approx(by_hand, rel=1e-12)


sizes = st.floats(0.01, 50.0).map(lambda value: round(value, 3))


@given(
    steps=st.lists(st.tuples(sizes, sizes, sizes), min_size=1, max_size=8),
    bored=st.booleans(),
    sloped=st.booleans(),
)
def test_any_turned_profile_is_a_solid_of_its_volume(steps, bored, sloped):
    """Steps of own length, bore and wall: volume by summing tubes or frustums."""
    x, outside, inside, by_hand = 0.0, [], [], 0.0
    walls = [(bore if bored else 0.0, (bore if bored else 0.0) + wall) for _, bore, wall in steps]
    least = max(bore for bore, _ in walls)
    walls = [(bore, max(outer, least + 0.01)) for bore, outer in walls]
    for index, ((length, _, _), (bore, outer)) in enumerate(zip(steps, walls, strict=True)):
        after = walls[min(index + 1, len(walls) - 1)][1] if sloped else outer
        outside += [(x, outer), (x + length, after)]
        inside += [(x, bore), (x + length, bore)]
        cone = length / 3 * (outer**2 + outer * after + after**2)
        by_hand += math.pi * (cone - length * bore**2)
        x += length
    profile = tidy([*inside, *reversed(outside)])
    assert bounds_solid(profile)
    (faces,) = (
        StepFile(
            step([SolidBody("c", "c", "m", profile, ((0.0, 0.0, 0.0),))], name="c", program="p")
        )
        .solids()
        .values()
    )
    assert volume(faces) == pytest.approx(by_hand, rel=1e-9)


def test_unsound_profiles_are_refused():
    """What bounds no single solid: crossed, flat, beyond the axis, pinched, with a void inside."""
    flat = ((0.0, 1.0), (2.0, 1.0), (4.0, 1.0))
    crossed = ((0.0, 0.0), (2.0, 0.0), (0.0, 2.0), (2.0, 2.0))
    beyond = ((0.0, -1.0), (2.0, -1.0), (2.0, 1.0), (0.0, 1.0))
    pinched = ((0.0, 0.0), (1.0, 1.0), (1.0, 2.0), (0.0, 2.0))
    void = ((0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (2.0, 1.0), (2.0, 0.0), (3.0, 0.0), (3.0, 2.0),
            (0.0, 2.0))  # fmt: skip
    for profile in (flat, crossed, beyond, pinched, void, ()):
        assert not bounds_solid(tidy(profile)), profile


def test_joined_leaves_apart_what_does_not_touch():
    """Plates with their skirts are two bodies; equal edges apart stay apart."""
    plate = ((0.0, 0.0), (2.0, 0.0), (2.0, 5.0), (0.0, 5.0))
    other = tuple((x + 20.0, r) for x, r in plate)
    skirt = ((2.0, 4.0), (6.0, 4.0), (6.0, 5.0), (2.0, 5.0))
    far = ((16.0, 4.0), (20.0, 4.0), (20.0, 5.0), (16.0, 5.0))
    first, last = joined([plate, other, skirt, far])
    assert first == ((0.0, 0.0), (2.0, 0.0), (2.0, 4.0), (6.0, 4.0), (6.0, 5.0), (0.0, 5.0))
    assert last == ((16.0, 4.0), (20.0, 4.0), (20.0, 0.0), (22.0, 0.0), (22.0, 5.0), (16.0, 5.0))


def test_a_section_that_bounds_no_solid_is_named():
    """Grooves that overlap are one line, not a broken solid; the reader refuses most of them."""
    evaluation = ao.evaluate(bench())
    crossed = ((0.0, 0.0), (0.02, 0.0), (0.0, 0.02), (0.02, 0.02))
    outlines = [
        replace(one, polygons=(crossed,)) if one.part == "piston" else one
        for one in evaluation.outlines
    ]
    with pytest.raises(ao.InputError) as caught:
        bodies(replace(evaluation, outlines=tuple(outlines)))
    (fault,) = caught.value.diagnostics
    assert fault.message.startswith("piston: the outline of its section crosses itself")
    assert fault.remedy


@pytest.mark.parametrize(
    "joint",
    [
        "type: double_lap\n  length: 12 mm\n  inner_wall: 1 mm",
        "type: tapered_lap\n  length: 20 mm\n  tip: 0.25\n  taper_length: 8 mm",
        "type: tapered_lap\n  length: 20 mm\n  tip: 0.25\n  taper_length: 20 mm",
    ],
)
def test_bonded_skirts_in_the_bore_and_tapered(joint):
    """Caps with both forms of skirts are solids of the mass model's weight."""
    text = (DESIGNS / "knee_bonded.yaml").read_text("utf-8").partition("\nvariables:")[0] + "\n"
    text = text.replace("type: bond", joint).replace("  length: 20 mm\n  wall: 1.5", "  wall: 1.5")
    found = check_masses(*exported(text))
    assert found["caps"] > 0
