"""The recorded models of whole designs: equal to the models at random points, and on the way."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import actuator_opt as ao
from actuator_opt.base.numeric import STEP
from actuator_opt.base.symbolic import program as programs, program_store
from actuator_opt.optimisation.actuator import build
from actuator_opt.optimisation.run import optimise

pytestmark = pytest.mark.skipif(not programs.AVAILABLE, reason="the machine was not built")
ROOT = Path(__file__).parents[2]
FREE = {
    "aalto_40_25_220": "cylinder.bore: {lower: 38 mm, upper: 44 mm}",
    "course_cylinder": "cylinder.bore: {lower: 28 mm, upper: 40 mm}",
    "elasswad_knee": "cylinder.bore: {lower: 10 mm, upper: 30 mm}",
    "huang_110_80_560": "cylinder.stroke: {lower: 300 mm, upper: 700 mm}",
}
"""A variable for every shipped design without any."""
DESIGNS = sorted(path.stem for path in ROOT.glob("designs/*.yaml") if path.stem != "knee_choices")
"""Shipped designs; the models of a choice of joints are those of its combinations."""


def text_of(name):
    """Text of a shipped design, with a variable and an objective."""
    text = (ROOT / f"designs/{name}.yaml").read_text("utf-8")
    text = text.replace("file: cycles/", f"file: {ROOT}/designs/cycles/")
    if name in FREE:
        text += f"\nvariables:\n  {FREE[name]}\n"
        if "\nobjective:" not in text:
            text += "objective: {minimise: mass}\n"
    return text


def problem_of(name):
    """The problem of a design, with its models recorded."""
    actuator = build(ao.read(text_of(name)).subject())
    steps = complex_steps(actuator.problem.start[:, None])
    with np.errstate(all="ignore"):
        actuator.evaluate(steps)
    return actuator


def complex_steps(points):
    """Copies of points (n, k) with a complex step in each input, (n, k n)."""
    count, k = points.shape
    repeated = np.repeat(points, count, axis=1).astype(complex)
    return repeated + 1j * STEP * np.tile(np.diag(points.mean(axis=1)), k)


def rows(values, count):
    """Objective and margins as an array (rows, points)."""
    return np.concatenate([np.broadcast_to(values.objective, (1, count)), values.constraints])


USUAL = ("aerospace", "elasswad_knee", "knee", "knee_bonded", "servo_test_rig", "steel_baseline")
"""Designs that between them have every joint, wall and mount; oil films and cycles take seconds."""


@pytest.mark.parametrize(
    "name", [n if n in USUAL else pytest.param(n, marks=pytest.mark.long) for n in DESIGNS]
)
def test_a_recorded_design_equals_its_models(name):
    """At 200 points, half of them random in the box and half near the start.

    NaN in the same places, values to 1e-11, slopes to 1e-9.
    """
    actuator = problem_of(name)
    assert actuator.recorded.reason == ""
    rng = np.random.default_rng(200)
    low, high = actuator.problem.lower[:, None], actuator.problem.upper[:, None]
    start = actuator.problem.start[:, None]
    wide = low + (high - low) * rng.random((len(low), 100))
    near = np.clip(start * (1 + 0.02 * rng.standard_normal((len(low), 100))), low, high)
    points = np.concatenate([wide, near], axis=1)
    with np.errstate(all="ignore"):
        mine = rows(actuator.evaluate(points), 200)
        theirs = rows(actuator.by_models(points, {}), 200)
        few = points[:, ::20]
        my_steps, their_steps = (
            rows(values, few.size).imag / STEP
            for values in (
                actuator.evaluate(complex_steps(few)),
                actuator.by_models(complex_steps(few), {}),
            )
        )
    np.testing.assert_allclose(mine, theirs, rtol=1e-11, atol=1e-11, equal_nan=True)
    sound = np.isfinite(theirs[:, ::20].repeat(len(low), axis=1)) & np.isfinite(their_steps)
    room = 1e-9 * np.maximum(1.0, np.abs(their_steps))
    assert np.all(np.abs(my_steps - their_steps)[sound] <= room[sound])
    assert actuator.recorded.outside <= 0.3 * actuator.recorded.points


def test_the_search_for_the_held_spool_is_recorded(monkeypatch):
    """A lapped spool whose overlap and clearance vary, and a design that lacks pressure to hold."""
    text = text_of("servo_knee").replace("  leakage_flow: 0.2 l/min\n", "  spool:\n"
        "    {type: lapped, stroke: 0.5 mm, overlap: 0 um, clearance: 3 um}\n")  # fmt: skip
    text = text.replace("  leakage_drop: 50 bar\n", "").replace(
        "\nvariables:\n",
        """
variables:
  valve.spool.overlap: {lower: -30 um, upper: 20 um}
  valve.spool.clearance: {lower: 1 um, upper: 8 um}
""",
    )
    monkeypatch.setattr("test_recorded_models.text_of", lambda name: text)
    test_a_recorded_design_equals_its_models("")


CURVE = """  rated_drop: 35 bar
  flow_curve: |
    signal [%],q [l/min]
    0,0.1
    4,0.15
    8,0.6
    30,6
    100,20
"""
LEAKS = """  rated_flow: 20 l/min
  leakage_flow: 0.2 l/min
  rated_viscosity: 32 mm^2/s
  spool: {type: lapped, stroke: 0.5 mm, overlap: 5 um}
"""


@pytest.mark.long
@pytest.mark.parametrize(
    ("valve", "varied"),
    [
        (CURVE, "  valve.rated_drop: {lower: 20 bar, upper: 50 bar}\n"),
        (LEAKS, "  valve.leakage_flow: {lower: 0.05 l/min, upper: 0.4 l/min}\n"),
    ],
)  # fmt: skip
def test_a_valve_by_its_data_sheet_is_recorded(valve, varied, monkeypatch):
    """A flow curve, and a clearance by leakage, each with a variable."""
    old = "  natural_frequency: 120 Hz\n"
    block = re.compile(r"(?m)^valve:.*\n(?:  .*\n)+")
    text = block.sub(lambda _: f"valve:\n{valve}{old}", text_of("servo_knee"))
    text = text.replace("\nvariables:\n", f"\nvariables:\n{varied}")
    monkeypatch.setattr("test_recorded_models.text_of", lambda name: text)
    test_a_recorded_design_equals_its_models("")


def test_every_number_is_an_input():
    """One recording serves changed limits, forces, pressures and material values."""
    actuator = problem_of("knee_bonded")
    x = actuator.problem.start
    paths = actuator.fixed_numbers(x)
    assert set(paths) <= set(actuator.recorded.names)
    assert len(paths) > 100
    with np.errstate(all="ignore"):
        mine = actuator.number_steps(x, paths)
        actuator.recorded.reason = "compared"
        theirs = actuator.number_steps(x, paths)
    np.testing.assert_allclose(mine.constraints.real, theirs.constraints.real, rtol=1e-11)
    room = 1e-9 * np.maximum(1.0, np.abs(theirs.constraints.imag / STEP))
    assert np.all(np.abs(mine.constraints.imag - theirs.constraints.imag) / STEP <= room)


def test_custom_metrics_are_not_recorded():
    """Code of a user may do anything: such designs stay with NumPy."""
    own = ao.metric("own")(lambda v: 1.0)
    design = ao.read(text_of("steel_baseline"), plugins=[own])
    assert build(design.subject()).recorded is None


@pytest.mark.long
def test_the_optimum_is_that_of_the_models(monkeypatch):
    """The search over recorded models ends at the same optimum as the search over the models."""
    subject = ao.read(text_of("knee_bonded")).subject()
    recorded = optimise(subject, prices=False)
    monkeypatch.setattr(programs, "AVAILABLE", False)
    plain = optimise(subject, prices=False)
    assert recorded.to_dict()["models_run_by"] == "compiled program"
    assert plain.to_dict()["models_run_by"] == "NumPy"
    assert recorded.objective_value == pytest.approx(plain.objective_value, rel=1e-10)
    for mine, theirs in zip(recorded.variables, plain.variables, strict=True):
        assert mine.value == pytest.approx(theirs.value, rel=1e-6), mine.name


def test_a_wrong_recording_repeats_the_search(monkeypatch):
    """The optimum is compared with the models; if it differs, the search runs without recording."""
    subject = ao.read(text_of("steel_baseline")).subject()
    plain = optimise(subject, prices=False)
    values = programs.Program.values

    def wrong(program, points):
        result = values(program, points)
        return result if len(points) == 2 else result + 1e-6

    monkeypatch.setattr(programs.Program, "values", wrong)
    repeated = optimise(subject, prices=False)
    assert repeated.objective_value == pytest.approx(plain.objective_value, rel=1e-10)


def test_a_changed_subject_is_recorded_anew():
    """A recording belongs to its problem: another number that is no input gives other results."""
    subject = ao.read(text_of("steel_baseline")).subject()
    changed = replace(subject, reserves={"buckling_factor": 0.1})
    assert build(subject).recorded is not build(changed).recorded


@pytest.mark.parametrize(
    ("old", "one", "other"),
    [("iso_vg_32", "iso_vg_32", "iso_vg_46"), ("t700_epoxy", "as4_3501_6", "eglass_epoxy")],
)
def test_designs_with_other_materials_share_a_recording(old, one, other):
    """Their tables, strengths and knock-downs are inputs: one recording gives both results."""
    text = text_of("knee_bonded")
    assert old in text
    first, second = (build(ao.read(text.replace(old, new)).subject()) for new in (one, other))
    rng = np.random.default_rng(7)
    low, high = first.problem.lower[:, None], first.problem.upper[:, None]
    points = low + (high - low) * rng.random((len(low), 20))
    with np.errstate(all="ignore"):
        first.evaluate(points)
        mine = rows(second.evaluate(points), 20)
        theirs = rows(second.by_models(points, {}), 20)
        others = rows(first.by_models(points, {}), 20)
    assert second.recorded.recording is first.recorded.recording
    np.testing.assert_allclose(mine, theirs, rtol=1e-11, atol=1e-11, equal_nan=True)
    assert not np.allclose(theirs, others, equal_nan=True)


@pytest.mark.parametrize(
    ("name", "old", "new", "equal"),
    [
        ("knee_bonded", "max: 290 N", "max: 280 N", True),
        ("knee_bonded", "upper: 4 mm", "upper: 5 mm", True),
        ("knee_bonded", "  seals: sliding", "  seals: sticking", False),
        pytest.param(
            "huang_110_80_560", "upper: 700 mm", "upper: 690 mm", False, marks=pytest.mark.long
        ),
    ],
)
def test_which_designs_share_a_recording(name, old, new, equal):
    """Limits and bounds are no part of the structure; oil films are solved between the bounds."""
    text = text_of(name)
    if old not in text:
        text += "\nstiffness:\n  seals: sliding\n"
    assert text.replace(old, new) != text
    keys = [
        program_store.key_of(build(ao.read(t).subject()).recorded.structure)
        for t in (text, text.replace(old, new))
    ]
    assert (keys[0] == keys[1]) is equal
