"""Order of assembly: ends that do not open, narrow openings, eyes, and rings on their way."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

import actuator_opt as ao
from actuator_opt.base.errors import InputError
from actuator_opt.design import assembly, wall_faults
from actuator_opt.evaluation.outline import notes
from actuator_opt.joints.joint import BarrelOpening
from actuator_opt.joints.kinds import JOINTS

DESIGNS = Path(__file__).parents[2] / "designs"
FIXED = BarrelOpening("never", "")


def design(name="steel_baseline", text=None, **changes):
    """A shipped design with changed values, or with another text."""
    found = ao.read((DESIGNS / f"{name}.yaml") if text is None else text, set=changes)
    return found.subject().design


def opened(monkeypatch, joint, opening):
    """Let a kind of joint have another opening."""
    changed = {**JOINTS, joint: replace(JOINTS[joint], opening=lambda _: opening)}
    monkeypatch.setattr(wall_faults, "JOINTS", changed)


def apart(cap, head):
    """The steel cylinder of fixed bore, whose ends have joints of their own."""
    text = (DESIGNS / "steel_baseline.yaml").read_text("utf-8")
    text = text[: text.index("\nvariables:")] + text[text.index("\nrequirements:") :]
    start, stop = text.index("retention:\n"), text.index("clevis:\n")
    blocks = {
        "thread": "{type: thread, length: 10 mm, wall: 2 mm, thread: {pitch: 1 mm}}",
        "bond": "{type: bond, length: 20 mm, wall: 2 mm, material: epoxy_structural}",
    }
    ends = f"retention:\n  cap: {blocks[cap]}\n  head: {blocks[head]}\n\n"
    return text[:start] + ends + text[stop:]


def faults(text):
    """Every fault of a file, as (PATH, message)."""
    with pytest.raises(InputError) as error:
        ao.read(text)
    return [(found.path, found.message) for found in error.value.diagnostics]


def test_two_ends_that_do_not_open(monkeypatch):
    """One line at the type of the joint; one fixed end is enough if the other opens."""
    words = "neither end of the barrel can be opened, so the piston cannot be inserted"
    text = apart("bond", "bond")
    opened(monkeypatch, "bond", FIXED)
    assert ("retention.head.type", words) in faults(text)
    block = text[text.index("retention:\n") : text.index("clevis:\n")]
    both = "retention: {type: bond, length: 20 mm, wall: 2 mm, material: epoxy_structural}\n\n"
    assert ("retention.type", words) in faults(text.replace(block, both))
    assert ao.read(apart("bond", "thread"))
    assert ao.read(apart("thread", "bond"))


def test_an_opening_that_the_piston_does_not_pass(monkeypatch):
    """The narrower end is named, and both sizes; an end of the bore's size is wide enough."""
    text = apart("thread", "bond")
    opened(monkeypatch, "bond", BarrelOpening("once", "", diameter=22e-3))
    ((path, message),) = faults(text)
    assert path == "retention.head.type"
    assert message.startswith("the opening of 22 mm is narrower than the piston (23 mm)")
    opened(monkeypatch, "bond", BarrelOpening("once", "", diameter=23e-3))
    assert ao.read(text)
    opened(monkeypatch, "bond", BarrelOpening("never", "", diameter=22e-3))
    assert ao.read(text)  # nothing passes an end that never opens


def test_a_screwed_plug_reports_a_narrow_thread_once():
    """The fault of the joint itself, at its thread, is not repeated."""
    text = (DESIGNS / "knee.yaml").read_text("utf-8")
    text = text[: text.index("\nvariables:")] + text[text.index("\nrequirements:") :]
    start, stop = text.index("retention:\n"), text.index("clevis:\n")
    block = "{type: plug_thread, length: 8 mm, wall: 1.5 mm, thread: {pitch: 0.5 mm, diameter: "
    narrow = f"{text[:start]}retention: {block}21.8 mm}}}}\n\n{text[stop:]}"
    assert [path for path, _ in faults(narrow)] == ["retention.thread.diameter"]


def test_an_eye_made_with_the_rod():
    """It does not pass the head, unless the piston has a nut; a screwed eye comes off."""
    text = (DESIGNS / "steel_baseline.yaml").read_text("utf-8")
    start = text.index("  thread:\n", text.index("\nrod:"))
    block = text[start : text.index("\n\n", start)]
    nut = text[text.index("  nut:") : text.index("head:\n")]
    assert not list(assembly.warnings(design(text=text)))
    whole = text.replace(block, "")
    assert not list(assembly.warnings(design(text=whole)))
    first = assembly.order(design(text=whole))[0]
    assert (
        first == "Set the head on the rod, from its inner end, then the piston and tighten its nut."
    )
    (words,) = assembly.warnings(design(text=whole.replace(nut, "\n")))
    assert words.startswith("assembly: the rod's eye, 16 mm, does not pass the head")


def test_rings_that_pass_a_thread_or_a_groove():
    """Static rings stand 20 % of 1.78 mm and 0.05 mm above the bore; a wide groove catches them."""
    changes = {"retention.type": "plug_thread"}
    assert not list(assembly.warnings(design("knee_choices", **changes)))
    for step, count in ((0.001, 0), (-0.1, 1)):
        width = {"retention.thread.diameter": f"{23.812 + 1.0825 * 0.75 + step} mm"}
        found = list(assembly.warnings(design("knee_choices", **changes, **width)))
        assert len(found) == count
    assert "rings of 23.81 mm diameter scrape through the thread at the cap, 23.71 mm" in found[0]
    assert not list(
        assembly.warnings(design("knee_choices", **{"retention.ring_thickness": "1.7 mm"}))
    )
    (words,) = assembly.warnings(design("knee_choices", **{"retention.ring_thickness": "1.8 mm"}))
    assert "rings of 1.78 mm section fall into the groove at the cap, 1.8 mm wide" in words


def test_order_of_the_shipped_knee():
    """Piston and nut outside; head last, through the bore; numbered in drawings."""
    lines = assembly.order(design("knee"))
    assert [line.split()[0] for line in lines] == [
        "Set",
        "Screw",
        "Insert",
        "Its",
        "Screw",
        "Screw",
    ]
    assert "nut" in lines[0]
    assert lines[2] == "Insert piston, rod and head through the opening of 23.11 mm at the head."
    evaluation = ao.evaluate(ao.read(DESIGNS / "knee.yaml"))
    drawn = notes(evaluation.design, evaluation.lengths)
    assert [line for line in drawn if line.startswith("Assembly 3. Insert")]


def test_order_with_a_fixed_head_and_of_bonds(monkeypatch):
    """A fixed head: rod from inside, cap last. Two bonds close the seals in for good."""
    bonded = assembly.order(design("knee_bonded"))
    assert bonded[-1] == "After this, the seals inside cannot be replaced."
    opened(monkeypatch, "bond", FIXED)
    lines = assembly.order(design(text=apart("thread", "bond")))
    assert lines[0].startswith("Set the piston on the rod and tighten")
    assert lines[1] == "The head is made with the barrel."
    assert lines[2].endswith("at the cap.")
    assert lines[3] == "Screw the cap over the barrel."
    assert assembly.order(design("huang_110_80_560")) == []
    (third,) = [line for line in assembly.order(design("aerospace")) if "tie rods" in line]
    assert third.startswith("Clamp the cap and the head")
