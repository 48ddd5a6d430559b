"""Cap and head with joints of their own: `retention.cap` and `retention.head`."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

import actuator_opt as ao
from actuator_opt.base.errors import InputError
from actuator_opt.optimisation.run import optimise

DESIGNS = Path(__file__).parents[2] / "designs"
STEEL = (DESIGNS / "steel_baseline.yaml").read_text("utf-8")
STEEL = STEEL[: STEEL.index("  static:")] + STEEL[STEEL.index("load:\n") :]
KNEE = (DESIGNS / "knee_bonded.yaml").read_text("utf-8")
SCREWED = "    type: thread\n    length: 10 mm\n    wall: 2 mm\n    thread: {pitch: 1 mm}\n"
BONDED = "    type: bond\n    length: 25 mm\n    wall: 1.5 mm\n    material: epoxy_structural\n"
RODS = (
    "    type: tie_rods\n    length: 8 mm\n    material: steel_bolt_12_9\n"
    "    thread: {diameter: 6 mm, pitch: 1 mm}\n"
)


def variables(text, path, ends):
    """The block of a variable of `retention`, once for each end."""
    start = text.index(f"  {path}:\n")
    block = text[start:].split("\n  ", 3)
    block = "\n  ".join(block[:3]) + "\n"
    return text.replace(
        block, "".join(block.replace("retention.", f"retention.{end}.") for end in ends)
    )


def apart(text, cap, head):
    """A design with these joints of cap and head instead of its joint of both ends."""
    start, stop = text.index("retention:\n"), text.index("clevis:\n")
    text = f"{text[:start]}retention:\n  cap:\n{cap}  head:\n{head}\n{text[stop:]}"
    for path in ("retention.wall", "retention.length"):
        text = variables(text, path, ("cap", "head"))
    return text


def faults(text):
    """Every fault of a file, as (PATH, message, remedy)."""
    with pytest.raises(InputError) as error:
        ao.read(text)
    return [(d.path, d.message, d.remedy) for d in error.value.diagnostics]


@pytest.mark.parametrize("text", [STEEL, KNEE], ids=["screwed", "bonded"])
def test_the_same_joint_stated_for_each_end_changes_nothing(text):
    """Masses, factors and sections are those of the joint that holds for both ends."""
    block = text[text.index("retention:\n") : text.index("clevis:\n")]
    own = "".join(f"  {line}\n" for line in block.rstrip().splitlines()[1:])
    both, each = ao.evaluate(ao.read(text)), ao.evaluate(ao.read(apart(text, own, own)))
    assert each.mass_parts == both.mass_parts
    assert each.outlines == both.outlines
    for name, metric in both.metrics.items():
        assert each.metrics[name].value == metric.value, name
    assert {row.name: row.status for row in each.checks} == {
        row.name: row.status for row in both.checks
    }


@pytest.mark.long
def test_the_optimum_of_equal_ends_is_that_of_one_joint():
    """The optimiser has two more variables, and finds the same lengths at both ends."""
    block = KNEE[KNEE.index("retention:\n") : KNEE.index("clevis:\n")]
    own = "".join(f"  {line}\n" for line in block.rstrip().splitlines()[1:])
    both = optimise(ao.read(KNEE).subject(), prices=False)
    each = optimise(ao.read(apart(KNEE, own, own)).subject(), prices=False)
    assert each.objective_value == pytest.approx(both.objective_value, rel=1e-9)
    sizes = {variable.path: variable.value for variable in each.variables}
    for key in ("wall", "length"):
        assert sizes[f"retention.cap.{key}"] == pytest.approx(
            sizes[f"retention.head.{key}"], rel=1e-6
        )


def test_each_end_has_its_own_rows_mass_and_section():
    """A bonded cap and a screwed head: rows name the end; the skirts are drawn and weighed."""
    mixed = ao.evaluate(ao.read(apart(STEEL, BONDED, SCREWED)))
    subject = ao.read(apart(STEEL, BONDED, SCREWED)).subject()
    computed = ao.evaluation.compute(subject, subject.values()).computed
    working = computed.metrics["retention_factor"]
    alone = {}
    for name, block in (("cap", BONDED), ("head", SCREWED)):
        other = ao.read(apart(STEEL, block, block)).subject()
        rows = ao.evaluation.compute(other, other.values()).computed.metrics["retention_factor"]
        alone |= {place: rows[place] for place in rows if place.startswith(f"{name}: ")}
    assert {place.split(":")[0] for place in working} == {"cap", "head"}
    assert working.keys() == alone.keys()
    for place, row in working.items():
        assert np.asarray(row) == pytest.approx(np.asarray(alone[place]), rel=1e-12)
    both = [
        ao.evaluate(ao.read(apart(STEEL, block, block))).mass_parts for block in (BONDED, SCREWED)
    ]
    # plate of the cap and plate of the head differ in their hole only, so that the mean is exact
    assert mixed.mass_parts["barrel"] == pytest.approx(
        (both[0]["barrel"] + both[1]["barrel"]) / 2, rel=1e-12
    )
    density, outer, bore = 7850.0, 27e-3, 23e-3
    assert outer > bore
    skirts = {
        "cap": np.pi / 4 * ((outer + 3e-3) ** 2 - outer**2) * 25e-3,
        "head": np.pi / 4 * ((outer + 4e-3) ** 2 - outer**2) * 10e-3,
    }
    plates = {
        "cap": np.pi / 4 * (outer + 3e-3) ** 2 * 5e-3,
        "head": np.pi / 4 * ((outer + 4e-3) ** 2 - (13e-3 + 2 * 0.02e-3) ** 2) * 5e-3,
    }
    expected = density * (sum(skirts.values()) + sum(plates.values()))
    assert mixed.mass_parts["caps"] == pytest.approx(expected, rel=2e-3)
    (caps,) = (outline for outline in mixed.outlines if outline.part == "caps")
    volume = 0.0
    for polygon in caps.polygons:
        for (x1, r1), (x2, r2) in pairwise([*polygon, polygon[0]]):
            volume += np.pi * (x2 - x1) * (r1 * r1 + r1 * r2 + r2 * r2) / 3
    assert abs(volume) * density == pytest.approx(mixed.mass_parts["caps"], rel=0.05)


def test_one_end_with_several_types_to_choose_from():
    """`choices` may list the types of joint of one end; the other end keeps its own."""
    own = BONDED + "    thread: {pitch: 1 mm}\n"
    text = apart(STEEL, own, SCREWED) + "\nchoices:\n  retention.cap.type: [bond, thread]\n"
    result = ao.optimise(ao.read(text), prices=False)
    rows = {row.values["retention.cap.type"]: row for row in result.choices.combinations}
    assert set(rows) == {"bond", "thread"}
    assert rows["thread"].objective < rows["bond"].objective


@pytest.mark.parametrize(
    ("text", "path", "words"),
    [
        (apart(STEEL, SCREWED, RODS), "retention.head.type", "clamp both ends"),
        (apart(STEEL, SCREWED, SCREWED.replace("10 mm", "1 mm")), "retention.head.length",
         "less than one turn"),
        (apart(STEEL, SCREWED, BONDED.replace("    material: epoxy_structural\n", "")),
         "retention.head.material", "needs an adhesive"),
        (apart(STEEL, SCREWED, BONDED.replace("25 mm", "200 mm")), "retention.head.length",
         "the skirts of both ends meet"),
        (apart(STEEL, SCREWED, SCREWED).replace("  cap:\n", "  type: bond\n  cap:\n"),
         "retention.type", "without effect beside cap and head"),
        (apart(STEEL, SCREWED, SCREWED).replace(f"  head:\n{SCREWED}", "").replace(
            "retention.head.wall", "retention.cap.wall").replace(
            "retention.head.length", "retention.cap.length"),
         "retention.head", "head needs one too"),
        (apart(KNEE, BONDED, SCREWED), "barrel.layup[2].material", "retention.head.type"),
    ],
)  # fmt: skip
def test_what_two_ends_refuse(text, path, words):
    """Every fault is at the PATH of its own end."""
    found = [fault for fault in faults(text) if fault[0] == path and words in fault[1]]
    assert found, faults(text)
    assert found[0][2]
