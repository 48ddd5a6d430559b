"""Joints of caps and head: every kind is whole, and nothing incomplete is let in."""

from __future__ import annotations

import importlib
import json
import pkgutil
import re
from dataclasses import MISSING, fields, replace
from pathlib import Path

import numpy as np
import pytest

import actuator_opt as ao
from actuator_opt import joints
from actuator_opt.base import kinds
from actuator_opt.base.errors import InputError
from actuator_opt.design import read_design, with_values
from actuator_opt.design.schema import json_schema
from actuator_opt.design.writer import init_text
from actuator_opt.evaluation import compute
from actuator_opt.joints.joint import Joint, check
from actuator_opt.joints.kinds import JOINTS
from actuator_opt.metrics import METRICS
from actuator_opt.metrics.documentation import describe, function_of

DESIGNS = Path(__file__).parents[2] / "designs"
STEEL = (DESIGNS / "steel_baseline.yaml").read_text("utf-8").partition("\nvariables:")[0] + "\n"
STEEL = STEEL[: STEEL.index("  static:")] + STEEL[STEEL.index("load:\n") :]
RETENTION = STEEL[STEEL.index("retention:\n") : STEEL.index("\nclevis:")]
BLOCKS = {
    "bond": "type: bond\n  material: epoxy_structural\n  length: 20 mm\n  wall: 2 mm\n",
    "thread": "type: thread\n  length: 10 mm\n  wall: 2 mm\n  thread:\n    pitch: 1 mm\n",
    "double_lap": "type: double_lap\n  material: epoxy_structural\n  length: 14 mm\n"
    "  wall: 2 mm\n  inner_wall: 1.5 mm\n",
    "tapered_lap": "type: tapered_lap\n  material: epoxy_structural\n  length: 20 mm\n"
    "  wall: 2 mm\n  tip: 0.3\n  taper_length: 8 mm\n",
    "tie_rods": "type: tie_rods\n  material: steel_bolt_12_9\n  length: 8 mm\n  count: 6\n"
    "  preload: 40 kN\n  thread:\n    diameter: 6 mm\n    pitch: 1 mm\n",
    "plug_thread": "type: plug_thread\n  length: 8 mm\n  wall: 1.5 mm\n"
    "  thread:\n    pitch: 0.75 mm\n",
    "pins": "type: pins\n  material: steel_bolt_12_9\n  length: 36 mm\n  wall: 8 mm\n  count: 6\n"
    "  diameter: 4 mm\n  edge: 14 mm\n  rows: 2\n  spacing: 14 mm\n",
    "shrink": "type: shrink\n  material: steel_42crmo4\n  length: 30 mm\n  wall: 3 mm\n"
    "  interference: 10 um\n  friction_coefficient: 0.15\n  relaxation: 0.8\n",
    "retaining_ring": "type: retaining_ring\n  material: steel_bolt_12_9\n  length: 4 mm\n"
    "  groove_depth: 0.5 mm\n  ring_thickness: 2 mm\n  ring_width: 2 mm\n",
    "cone": "type: cone\n  length: 3 mm\n  wall: 3 mm\n  angle: 45 deg\n  depth: 3 mm\n"
    "  crest_radius: 3 mm\n  hoop_thickness: 2 mm\n  hoop_width: 2 mm\n",
}
"""A retention of each kind on a steel cylinder."""
LAYUP = STEEL[STEEL.index("  layup:") : STEEL.index("\nrod:")]
WOUND = "  layup:\n    - {material: al_7075_t6, thickness: 1.5 mm}\n" + "".join(
    f"    - {{material: t700_epoxy, angle: {angle} deg, thickness: {thickness} mm}}\n"
    for angle, thickness in ((88, 0.5), (45, 2), (0, 1))
)
HELICAL = LAYUP + "    - {material: t700_epoxy, angle: 30 deg, thickness: 1 mm}\n"
LAYUPS = {"pins": WOUND, "cone": HELICAL}
"""The barrel of joints that a steel barrel cannot have."""
VALUES = {
    "wall": "3 mm",
    "material": "steel_42crmo4",
    "count": "7",
    "preload": "5 kN",
    "thread": "{diameter: 6 mm, pitch: 1 mm}",
    "edge": "12 mm",
    "interference": "10 um",
    "sleeve": "{material: al_7075_t6, wall: 3 mm, inner_length: 20 mm}",
}
"""A value of every key that some joint does not use, none of them a default."""

each = pytest.mark.parametrize("joint", JOINTS.values(), ids=JOINTS.names)


def text_of(block):
    """The steel cylinder with another retention, and the barrel that this needs."""
    text = STEEL.replace(RETENTION, f"retention:\n  {block}")
    return text.replace(LAYUP, LAYUPS.get(block.partition("\n")[0].removeprefix("type: "), LAYUP))


def bare_of(joint):
    """The cylinder of a joint without retention."""
    return STEEL.replace(RETENTION, "").replace(LAYUP, LAYUPS.get(joint.name, LAYUP))


def faults(text):
    """Every fault of a file."""
    with pytest.raises(InputError) as error:
        read_design(text, materials=ao.load_library())
    return error.value.diagnostics


def without(block, key):
    """A block without the line of a key and what stands below it."""
    lines, kept, depth = block.splitlines(), [], None
    for line in lines:
        indent = len(line) - len(line.lstrip())
        if depth is not None and indent > depth:
            continue
        depth = indent if line.lstrip().startswith(f"{key}:") else None
        if depth is None:
            kept.append(line)
    return "\n".join(kept) + "\n"


# --- every kind -----------------------------------------------------------------------------


def modules_with_joints(package):
    """Every joint that stands in a module of a package, by module."""
    return {
        name: joint
        for _, name, _ in pkgutil.iter_modules(package.__path__)
        if isinstance(
            joint := getattr(importlib.import_module(f"{package.__name__}.{name}"), "JOINT", None),
            Joint,
        )
    }


def unregistered(found):
    """Joints of modules that the registry does not list, and modules named otherwise."""
    return [name for name, joint in found.items() if JOINTS.get(name) is not joint]


def test_every_module_is_registered_under_its_name():
    """A joint is in the registry under the name of its module; one that is not is found."""
    found = modules_with_joints(joints)
    assert tuple(sorted(found)) == tuple(sorted(JOINTS.names))
    assert unregistered(found) == []
    assert unregistered(found | {"weld": replace(found["bond"], name="weld")}) == ["weld"]
    assert set(BLOCKS) == set(JOINTS.names)


@each
def test_words(joint):
    """Name and meaning stand in the schema of the design file and in the start file's comment."""
    schema = json_schema()["properties"]["retention"]["properties"]["type"]
    assert joint.name in schema["enum"]
    assert f"{joint.name}: {joint.help}" in json.dumps(schema)
    (line,) = (one for one in init_text().splitlines() if one.startswith("  type: bond"))
    assert joint.name in line
    with pytest.raises(InputError, match=joint.name):
        read_design(text_of("type: weld\n  length: 10 mm\n"))


def _turned(polygon):
    """Volume of a polygon of (axial position, radius) turned about the axis (Pappus)."""
    moment = 0.0
    for (x, r), (far, high) in zip(polygon, (*polygon[1:], polygon[0]), strict=True):
        moment += (x * high - far * r) * (r + high) / 6
    return 2 * np.pi * abs(moment)


@each
def test_it_holds_a_cap_with_a_rod(joint):
    """In a double-rod cylinder both ends have a gland; caps and glands weigh as they are drawn."""
    text = text_of(BLOCKS[joint.name])
    start = text.index("  nut:")  # its hole would have to pass over the second rod
    text = text[:start] + text[text.index("\nhead:\n") :]
    changes = {"cylinder.type": "double_rod", "cylinder.mount": "cap_flange"}
    changes |= {"second_rod.outer_diameter": "10 mm", "second_rod.inner_diameter": "0 mm"}
    evaluation = ao.evaluate(ao.read(text, set=changes))
    library = ao.load_library()
    for part in ("caps", "glands", "second rod"):
        drawn = sum(
            library.get(outline.material).numbers["density"] * sum(map(_turned, outline.polygons))
            for outline in evaluation.outlines
            if outline.part == part
        )
        assert drawn == pytest.approx(evaluation.mass_parts[part], rel=1e-6), part
    assert evaluation.metrics["retention_factor"].value > 0


@each
def test_what_it_needs(joint):
    """Without a key that it needs a file is refused at that key, with a remedy."""
    for field in joint.fields:
        parts = field.key.split(".")
        if field.missing:
            (fault,) = faults(text_of(without(BLOCKS[joint.name], parts[-1])))
            assert fault.path == f"retention.{field.key}"
            assert fault.message == field.missing
            assert fault.remedy


@each
def test_what_it_refuses(joint):
    """A key that it does not use is one fault, unless a choice among the joints uses it."""
    used = {field.key.partition(".")[0] for field in joint.fields}
    refused = [key for key in VALUES if key not in used]
    assert refused
    for key in refused:
        text = text_of(f"{BLOCKS[joint.name]}  {key}: {VALUES[key]}\n")
        (fault,) = faults(text)
        assert fault.path == f"retention.{key}"
        assert fault.remedy.startswith("remove the line")
        users = [one.name for one in JOINTS.values() if key in {field.key for field in one.fields}]
        listed = f"{text}choices:\n  retention.type: [{joint.name}, {users[0]}]\n"
        assert getattr(read_design(listed).design.retention, key) is not None


@each
def test_a_default_is_no_statement(joint):
    """Defaults of keys that it does not use stand in every design, and are no fault."""
    design = read_design(text_of(BLOCKS[joint.name])).design
    assert with_values(design, {"retention.length": design.retention.length}) == design


@each
def test_its_metrics(joint):
    """The factors of retention and its own metrics are computed; those of others say why not."""
    subject = ao.read(text_of(BLOCKS[joint.name])).subject()
    computed = compute(subject, subject.values()).computed
    for metric in ("retention_factor", "retention_burst_factor", *joint.metrics):
        values = computed.metrics[metric].values()
        assert values
        assert all(np.isfinite(np.real(value)).all() for value in values)
        assert metric in METRICS
    for other in JOINTS.values():
        for metric, absent in other.metrics.items():
            if other is not joint:
                assert metric not in computed.metrics
                assert computed.why[metric] == absent


@each
def test_its_mass(joint):
    """It adds mass. Lighter are at most the barrel, caps in it, and a plug in an inner skirt."""
    evaluation = ao.evaluate(ao.read(text_of(BLOCKS[joint.name])))
    bare = ao.evaluate(ao.read(bare_of(joint)))
    gained = {part: evaluation.mass_parts[part] - bare.mass_parts[part] for part in bare.mass_parts}
    assert sum(gained.values()) > 0
    enclosed = {"glands"} if joint.inner_skirt else {"caps"} if gained["barrel"] > 0 else set()
    assert all(gain >= 0 for part, gain in gained.items() if part not in {"barrel", *enclosed})


def volume(polygon):
    """Volume of a polygon of the half-section turned about the axis."""
    turned = sum(
        (x2 - x1) * (r1 * r1 + r1 * r2 + r2 * r2)
        for (x1, r1), (x2, r2) in zip(polygon, polygon[1:] + polygon[:1], strict=True)
    )
    return abs(np.pi * turned / 3)


def moved_to_origin(outline):
    """Part, material and rounded polygons of an outline, moved along the axis to start at 0."""
    start = min(x for polygon in outline.polygons for x, _ in polygon)
    shapes = [[(round(x - start, 12), round(r, 12)) for x, r in one] for one in outline.polygons]
    return outline.part, outline.material, shapes


@each
def test_its_outline(joint):
    """The section shows the joint, and its turned parts and bars weigh what the mass model says."""
    found = ao.read(text_of(BLOCKS[joint.name]))
    evaluation, bare = ao.evaluate(found), ao.evaluate(ao.read(bare_of(joint)))
    known = [moved_to_origin(one) for one in bare.outlines]
    drawn = [one for one in evaluation.outlines if moved_to_origin(one) not in known]
    assert drawn
    numbers = found.subject().numbers
    names = {one.part: "fastening" for one in drawn} | {"caps": "caps", "glands": "glands"}
    names |= {one.part: "barrel" for one in drawn if re.match("layup|.*plies", one.part)}
    weights = dict.fromkeys((names[one.part] for one in drawn), 0.0)
    for outline in drawn:
        size = 0.0
        for polygon in outline.polygons:
            shape = [point[:: -1 if outline.radial else 1] for point in polygon]
            radii = [radius for _, radius in shape]
            axis = (min(radii) + max(radii)) / 2 if outline.bars else 0.0
            half = [(x, max(radius - axis, 0.0)) for x, radius in shape]
            size += max(outline.bars, 1) * volume(half)
        density = numbers[f"materials.{outline.material}.density"]
        weights[names[outline.part]] += size * density
    for part, weight in weights.items():
        own = evaluation.mass_parts[part] - (bare.mass_parts[part] if part == "fastening" else 0.0)
        assert weight == pytest.approx(own, rel=1e-9)


@each
def test_its_models(joint):
    """Each model behind its places has a source, and each place of its factors a model."""
    for model in joint.models.values():
        assert describe(function_of(model)).reference
    subject = ao.read(text_of(BLOCKS[joint.name])).subject()
    computed = compute(subject, subject.values()).computed
    for place in computed.metrics["retention_factor"]:
        assert ("retention_factor", place) in joint.models


# --- what is not whole ----------------------------------------------------------------------


@pytest.mark.parametrize("piece", [field.name for field in fields(Joint)])
def test_a_missing_piece_is_no_joint(piece):
    """No piece has a default: leaving one out fails where the joint is made."""
    assert all(field.default is field.default_factory is MISSING for field in fields(Joint))
    bond = JOINTS["bond"]
    pieces = {field.name: getattr(bond, field.name) for field in fields(Joint)}
    del pieces[piece]
    with pytest.raises(TypeError, match=piece):
        Joint(**pieces)


def test_two_of_one_name():
    """A doubled name is refused by the registry."""
    bond = JOINTS["bond"]
    with pytest.raises(ValueError, match="bond"):
        kinds.kinds("joint", bond, replace(JOINTS["thread"], name="bond"))


def test_empty_pieces():
    """A piece that must be given is neither None nor empty text."""
    for piece in ("help", "noun"):
        with pytest.raises(ValueError, match=piece):
            kinds.kinds("joint", replace(JOINTS["bond"], **{piece: ""}))
    for piece in ("fit", "mass", "outline", "strength"):
        with pytest.raises(ValueError, match=piece):
            kinds.kinds("joint", replace(JOINTS["bond"], **{piece: None}))


def test_two_that_claim_one_metric():
    """A metric, a model's place or a key of its own belongs to one joint."""
    rods = JOINTS["tie_rods"]
    with pytest.raises(ValueError, match="joint_factor"):
        check([rods, replace(JOINTS["bond"], metrics=rods.metrics)])


def test_an_unknown_word():
    """The nearest word is offered."""
    with pytest.raises(KeyError, match="tie_rods"):
        JOINTS["tie_rod"]


@pytest.mark.parametrize(("name", "inner"), [("pins", 11.5 + 1.5 - 8), ("cone", 11.5 - 3)])
def test_the_force_crosses_the_rim_behind_the_seal(name, inner):
    """Skirt and neck start outside the seal, inside its groove: lip in shear, metal in tension."""
    static = "  static: {compound: nbr_90, section: 1.78 mm, squeeze: 20 %}\n"
    text = text_of(BLOCKS[name]).replace(
        "\nload:\n", f"\n{static}\nload:\n".replace("\n\n", "\n"), 1
    )
    subject = ao.read(text, set={"caps.thickness": "6 mm"}).subject()
    run = compute(subject, subject.values())
    rows, loaded = run.computed.metrics["retention_burst_factor"], run.joints[0].loaded
    strength = 1e-6 * float(loaded.materials.allowable(loaded.end.cap, "ultimate_strength"))
    bottom, lip = 11.5 - 0.8 * 1.78, (6 - 1.3655 * 1.78) / 2
    held = 2 * np.pi * bottom * lip / 3**0.5 + np.pi * (bottom**2 - inner**2)
    force = float(np.squeeze(loaded.force))
    assert np.squeeze(rows["plug behind its static seal"]) == pytest.approx(
        strength * held / force, rel=1e-9
    )
    bare = ao.read(text_of(BLOCKS[name])).subject()
    found = compute(bare, bare.values()).computed.metrics["retention_burst_factor"]
    assert rows.keys() - found.keys() == {"plug behind its static seal"}


def test_threads_are_drawn():
    """Each end shows the flanks of its thread with its pitch, about the radius where parts meet."""
    for name, length, pitch in (("thread", 10e-3, 1e-3), ("plug_thread", 8e-3, 0.75e-3)):
        evaluation = ao.evaluate(ao.read(text_of(BLOCKS[name])))
        caps = next(x for x in evaluation.outlines if x.part == "caps")
        radii = {r for polygon in caps.polygons for _, r in polygon}
        assert len(evaluation.lines) == 2
        for line in evaluation.lines:
            xs, rs = np.array(line).T
            assert len(line) == 2 * int(length / pitch * (1 + 1e-9)) + 1
            assert np.diff(xs) == pytest.approx(pitch / 2)
            assert any(rs.min() < radius < rs.max() + 1e-9 for radius in radii)
            assert np.ptp(rs) == pytest.approx(0.6134 * pitch, rel=0.02)  # ISO 724: 17/24 H
    assert ao.evaluate(ao.read(text_of(BLOCKS["bond"]))).lines == ()
