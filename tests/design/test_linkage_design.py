"""A linkage in the design file: load cases by joint torque, speed and inertia, and their faults.

Hand values: the bench design is 198 mm from pin to pin, 138 mm barrel, two plates of 8 mm, 12 mm
rod and two eyes of 2 x 8 mm, and reaches 308 mm. Lengths and lever arms below come from the drawn
triangle: Heron's area over half the actuator's length, the cosine rule for the angle.
"""

from __future__ import annotations

import math

import numpy as np
import pytest
from cli_runner import BENCH
from hypothesis import given, strategies as st

import actuator_opt as ao
from actuator_opt.base.errors import InputError
from actuator_opt.base.numeric import STEP
from actuator_opt.design import with_values
from actuator_opt.design.schema import json_schema
from actuator_opt.design.writer import to_yaml
from actuator_opt.evaluation import compute
from actuator_opt.evaluation.linkage import at_stop
from actuator_opt.optimisation.actuator import build

CLOSED, STROKE = 0.198, 0.110
HEAD = BENCH[: BENCH.index("load:\n")]
TAIL = BENCH[BENCH.index("variables:\n") :]


def linkage(base, crank, offset=0.0):
    """The block of a linkage; mm and degrees."""
    return (
        f"linkage:\n  base_radius: {base} mm\n  crank_radius: {crank} mm\n"
        f"  angle_offset: {offset} deg\n"
    )


SQUARE = linkage(202.4, 151.8, 30)
"""Sides 3:4:5 at mid-stroke: 151.8, 202.4 and 198 + 55 = 253 mm, both radii square."""
WIDE = linkage(245, 70)
"""Its lever arm is largest inside the stroke: 70 mm, where the crank is square to the actuator."""


def case(*lines, name="a", direction="push"):
    """A load case of some lines."""
    return "\n    ".join([f"  - name: {name}\n    direction: {direction}", *lines]) + "\n"


def text(block, *cases, load="load:\n  mass: 20 kg\n", tail=TAIL):
    """The bench design with a linkage and load cases of its own."""
    return HEAD + load + block + "load_cases:\n" + "".join(cases) + tail


def done(words):
    """One pass over the models."""
    subject = ao.read(words).subject()
    return compute(subject, subject.values())


def faults(words):
    """PATH, message and remedy of every fault."""
    return [(fault.path, fault.message, fault.remedy) for fault in ao.check(words)]


def lever(base, crank, length):
    """Distance of the joint axis from the actuator's line, by Heron's area."""
    half = (base + crank + length) / 2
    return 2 * math.sqrt(half * (half - base) * (half - crank) * (half - length)) / length


def turned(base, crank, length):
    """Angle between both radii, by the cosine rule."""
    return math.acos((base**2 + crank**2 - length**2) / (2 * base * crank))


TORQUE = "joint_torque: 120 N*m"


def test_square_linkage_by_hand():
    """At 60 deg + 30 deg both radii are square: lever arm 151.8 * 202.4 / 253 = 121.44 mm."""
    found = done(text(SQUARE, case(TORQUE, "angle: 60 deg", "joint_speed: 2 rad/s")))
    assert float(found.state.force[0, 0]) == pytest.approx(120 / 0.12144, rel=1e-12)
    assert float(found.state.speed[0, 0]) == pytest.approx(0.24288, rel=1e-12)
    assert float(found.state.reach[0, 0]) == pytest.approx(0.055, rel=1e-12)
    torque = found.computed.metrics["joint_torque_min"]["position of the case"]
    push = found.computed.metrics["push_force"][""]
    assert float(torque[0, 0] / push[0, 0]) == pytest.approx(0.12144, rel=1e-12)


SAME = [
    case(TORQUE, "angle: 60 deg", "joint_speed: 2 rad/s"),
    case(TORQUE, "position: 50 %", "joint_speed: 2 rad/s"),
    case(TORQUE, "lever_arm: 121.44 mm", "position: 55 mm", "speed: 0.24288 m/s"),
    case("force: 988.14229249011857 N", "angle: 60 deg", "speed: 0.24288 m/s"),
]


@pytest.mark.parametrize("other", SAME[1:])
def test_one_duty_said_in_four_ways(other):
    """By angle, by position, by lever arm and by force: every metric is the same."""
    first, second = (ao.evaluate(ao.read(text(SQUARE, words))) for words in (SAME[0], other))
    for name, metric in first.metrics.items():
        if name != "geometry_joint_angle":
            value = second.metrics[name].value
            assert value == (None if metric.value is None else pytest.approx(metric.value)), name
    margins = [[row.margin for row in one.requirements] for one in (first, second)]
    assert margins[1] == pytest.approx(margins[0])


def test_an_own_lever_arm_comes_before_the_linkage():
    """joint_torque with lever_arm asks the same with a linkage as without."""
    words = case(TORQUE, "lever_arm: 40 mm")
    assert float(done(text(WIDE, words)).state.force[0, 0]) == 120 / 0.04
    row = ao.evaluate(ao.read(text(WIDE, words))).requirements[-1]
    assert (row.name, row.metric, row.limit) == ("force[a]", "push_force", pytest.approx(3000))


def test_worst_of_the_stroke():
    """Force at the least lever arm, speed at the largest, inertia at the least, each by Heron."""
    load = "load:\n  mass: 2 kg\n  inertia: 0.05 kg*m^2\n"
    found = done(text(WIDE, case(TORQUE, "joint_speed: 2 rad/s"), load=load))
    arms = [lever(0.245, 0.07, CLOSED + x) for x in np.linspace(0, STROKE, 2001)]
    assert min(arms) in (arms[0], arms[-1])
    assert float(found.state.force[0, 0]) == pytest.approx(120 / min(arms), rel=1e-11)
    assert float(found.state.speed[0, 0]) == pytest.approx(2 * 0.07, rel=1e-11)
    assert max(arms) == pytest.approx(0.07, rel=1e-6)
    own = sum(found.mass_parts[name] for name in ("rod", "piston", "fastening"))
    moving = 2 + 0.05 / min(arms) ** 2 + own
    assert float(found.motion.mass[0, 0]) == pytest.approx(moving, rel=1e-11)
    power = found.computed.metrics["power"][""]
    assert float(power[0, 0]) == pytest.approx(120 * 2, rel=1e-11)  # the joint's, not more


def test_metrics_of_the_joint():
    """Least torque: the net force on the smaller of both lever arms; range by the cosine rule."""
    words = text(WIDE, case(TORQUE), case("force: 1 kN", name="b", direction="pull"))
    found = ao.evaluate(ao.read(words))
    arms = {
        "retracted": lever(0.245, 0.07, CLOSED),
        "extended": lever(0.245, 0.07, CLOSED + STROKE),
    }
    least = found.metrics["joint_torque_min"]
    for name, force in (("a", "push_force"), ("b", "pull_force")):
        expected = found.metrics[force].value * min(arms.values())
        assert least.by_case[name] == pytest.approx(expected, rel=1e-11)
    assert least.place == min(arms, key=arms.get)
    assert least.model == "linkage.joint_torque"
    swept = turned(0.245, 0.07, CLOSED + STROKE) - turned(0.245, 0.07, CLOSED)
    assert found.metrics["joint_range"].value == pytest.approx(swept, rel=1e-11)
    assert found.metrics["geometry_dead_point"].value == pytest.approx(0.315 - 0.308, rel=1e-9)
    row = next(row for row in found.requirements if row.name == "torque[a]")
    assert (row.metric, row.limit, row.place) == ("joint_torque_min", 120.0, least.place)
    assert row.value == pytest.approx(least.by_case["a"])


def test_inertia_is_the_mass_it_weighs():
    """At a stated angle J/h^2 in kg is the same load: frequency, damping, end stop."""
    words = case(TORQUE, "angle: 60 deg", "joint_speed: 2 rad/s")
    joint = text(SQUARE, words, load="load:\n  mass: 2 kg\n  inertia: 0.3 kg*m^2\n")
    mass = 2 + 0.3 / 0.12144**2
    plain = text(SQUARE, words, load=f"load:\n  mass: {mass!r} kg\n")
    found, expected = (ao.evaluate(ao.read(words)).metrics for words in (joint, plain))
    for name in ("natural_frequency", "damping_ratio", "end_stop_energy", "end_stop_pressure"):
        assert found[name].value == pytest.approx(expected[name].value, rel=1e-9), name


def test_the_joint_brings_its_own_energy_to_the_stop():
    """At either stop J/h^2 and h omega give J omega^2/2, whatever the lever arm."""
    load = "load:\n  mass: 0 kg\n  inertia: 0.3 kg*m^2\n"
    cases = [
        case(TORQUE, "joint_speed: 2 rad/s"),
        case(TORQUE, "joint_speed: 3 rad/s", name="b", direction="pull"),
    ]
    state = done(text(WIDE, *cases, load=load)).state
    stop = at_stop(state.demands, state.push)
    energy = np.ravel(stop.mass * stop.speed**2 / 2)
    assert energy == pytest.approx([0.3 * 2**2 / 2, 0.3 * 3**2 / 2], rel=1e-12)
    arms = [lever(0.245, 0.07, CLOSED + STROKE), lever(0.245, 0.07, CLOSED)]
    assert np.ravel(stop.force) == pytest.approx(120 / np.array(arms), rel=1e-11)


@given(st.floats(0.02, 0.98), st.sampled_from([(245, 70, 0), (202.4, 151.8, 30), (90, 230, -20)]))
def test_virtual_work_of_the_joint(share, shape):
    """Torque times the joint's turn is force times the actuator's travel."""
    base, crank, offset = shape[0] / 1e3, shape[1] / 1e3, math.radians(shape[2])
    joint = JOINTS[shape]
    x, step = share * STROKE, 1e-6
    ends = [turned(base, crank, CLOSED + x + side * step) for side in (-1, 1)]
    arm = joint.lever_arm(x)
    assert arm * (ends[1] - ends[0]) == pytest.approx(2 * step, rel=1e-6)
    angle = joint.angle(x)
    assert angle == pytest.approx(turned(base, crank, CLOSED + x) - offset, abs=1e-12)
    assert joint.position(angle) == pytest.approx(x, abs=1e-12)
    assert min(joint.ends.values()) <= arm * (1 + 1e-12)
    assert arm <= joint.largest * (1 + 1e-12)


JOINTS = {
    shape: done(text(linkage(*shape), case(TORQUE))).state.joint
    for shape in [(245, 70, 0), (202.4, 151.8, 30), (90, 230, -20)]
}


def test_work_over_the_stroke():
    """The integral of a constant force's torque over the joint's range is force times stroke."""
    joint = JOINTS[245, 70, 0]
    x = np.linspace(0, STROKE, 4001)
    work = np.trapezoid(3000.0 * joint.lever_arm(x), joint.angle(x))
    assert work == pytest.approx(3000.0 * STROKE, rel=1e-6)


RADII = """\
variables:
  linkage.base_radius:
    lower: 232 mm
    upper: 262 mm
  linkage.crank_radius:
    lower: 57 mm
    upper: 120 mm
  linkage.angle_offset:
    lower: -20 deg
    upper: 20 deg
  load_cases[b].angle:
    lower: 40 deg
    upper: 70 deg
"""


def test_gradients_of_the_linkage():
    """Every row's complex step by radii, offset and angle agrees with central differences."""
    load = "load:\n  mass: 2 kg\n  inertia: 0.05 kg*m^2\n"
    cases = [
        case(TORQUE, "joint_speed: 2 rad/s"),
        case(TORQUE, "angle: 55 deg", "joint_speed: 1 rad/s", name="b"),
        case(TORQUE, "joint_speed: 1 rad/s", name="c", direction="pull"),
    ]
    wishes = "requirements:\n  joint_range:\n    min: 60 deg\n  natural_frequency:\n    min: 9 Hz\n"
    block = linkage(246.3, 71.7, 2)
    tail = TAIL.replace("variables:\n", RADII).replace("requirements:\n", wishes)
    problem = build(ao.read(text(block, *cases, load=load, tail=tail)).subject()).problem
    labels = ("objective", *problem.constraint_names)
    for label in ("joint_range", "torque[a] (a, extended)", "natural_frequency (c, loaded as "):
        assert any(one.startswith(label) for one in labels), label
    assert any(one.startswith("geometry_joint_angle (b, retracted)") for one in labels)
    start, count = problem.start, len(problem.names)
    scale = np.diag(start + (start == 0))
    exact = problem.rows(start[:, None] + 1j * STEP * scale).imag / STEP
    step = 1e-5
    above, below = (problem.rows(start[:, None] + sign * step * scale) for sign in (1, -1))
    central = ((above - below) / (2 * step)).real
    assert count == 7
    for row, label in enumerate(labels):
        size = np.abs(central[row]).max() + 1e-3
        assert exact[row] == pytest.approx(central[row], rel=1e-5, abs=1e-6 * size), label


def test_both_radii_free_end_at_an_optimum():
    """Where equal lever arms at both stops are best the optimum is exact: a row for each stop."""
    tail = TAIL.replace("variables:\n", RADII.partition("  linkage.angle_offset")[0])
    tail = tail.replace("requirements:\n", "requirements:\n  joint_range:\n    min: 95 deg\n")
    tail = tail.replace("    min: 6 kN/mm", "    min: 9 kN/mm")
    cases = [case("joint_torque: 200 N*m"), case(TORQUE, name="c", direction="pull")]
    found = ao.optimise(ao.read(text(WIDE, *cases, tail=tail)), prices=False, starts=2)
    assert found.status == "optimal"
    assert found.kkt.residual <= 1e-6
    held = {one for one in found.kkt.active if "retracted" in one or "extended" in one}
    assert {one.rpartition(" ")[2] for one in held} == {"retracted)", "extended)"}
    values = {one.path: one.value for one in found.variables}
    radii = values["linkage.base_radius"], values["linkage.crank_radius"]
    assert lever(*radii, CLOSED) == pytest.approx(lever(*radii, CLOSED + STROKE), rel=1e-4)


ONE = case(TORQUE)
# between the stops of WIDE: (245^2 + 70^2 - l^2)/(2 245 70) = cos 41.42 deg and cos 150.8 deg
FAULTS = [
    (linkage(245, 55), ONE, "linkage.crank_radius", "110 mm moves the joint past a dead point"),
    (linkage(238, 70), ONE, "linkage.base_radius", "198 mm to 308 mm from pin to pin"),
    (linkage(268, 70), ONE, "linkage.base_radius", "moves the joint past a dead point"),
    ("", ONE, "load_cases[a].lever_arm", "missing: joint_torque needs it, or a linkage"),
    ("", case("force: 1 kN", "angle: 40 deg"), "load_cases[a].angle", "no linkage stated"),
    ("", case("force: 1 kN", "joint_speed: 1 rad/s"), "load_cases[a].joint_speed", "no linkage"),
    (WIDE, case(TORQUE, "angle: 40 deg", "position: 0 mm"), "load_cases[a].angle", "position and"),
    (WIDE, case(TORQUE, "joint_speed: 1 rad/s", "speed: 0.1 m/s"), "load_cases[a].joint_speed",
     "speed and joint_speed"),
    (WIDE, case(TORQUE, "angle: 10 deg"), "load_cases[a].angle", "the joint is 41.42 deg"),
    (WIDE, case(TORQUE, "angle: 170 deg"), "load_cases[a].angle", "to 150.8 deg"),
    (WIDE, case("lever_arm: 40 mm"), "load_cases[a].joint_torque", "missing: required with "
                                                                   "lever_arm"),
    (WIDE, case("speed: 1 m/s"), "load_cases[a].force", "missing"),
    (WIDE, case(TORQUE, "joint_speed: 1 m/s"), "load_cases[a].joint_speed", "is a speed"),
    (linkage(-245, 70), ONE, "linkage.base_radius", "must be > 0"),
    ("linkage:\n  crank_radius: 70 mm\n", ONE, "linkage.base_radius", "missing"),
    ("linkage: 70 mm\n", ONE, "linkage", "need a block"),
]  # fmt: skip


@pytest.mark.parametrize(("block", "words", "path", "message"), FAULTS)
def test_faults(block, words, path, message):
    """Each is one clear line at its own place, with a remedy."""
    ((where, what, remedy),) = faults(text(block, words))
    assert where == path
    assert message in what
    assert remedy


def test_inertia_needs_a_linkage():
    """A moment of inertia without a joint is refused."""
    words = text("", case("force: 1 kN"), load="load:\n  inertia: 1 kg*m^2\n")
    ((where, what, remedy),) = faults(words)
    assert (where, what) == ("load.inertia", "no linkage stated")
    assert "load.mass" in remedy


@pytest.mark.parametrize("radius", [238.0001, 250, 267.9999])
def test_remedies_can_be_written(radius):
    """A crank of 70 mm on 198 to 308 mm takes 308 - 70 to 198 + 70 mm: the fault says so."""
    remedy = faults(text(linkage(237, 70), ONE))[0][2]
    assert remedy == "write more than 238 mm and less than 268 mm"
    assert faults(text(linkage(radius, 70), ONE)) == []


def test_angles_of_a_remedy_can_be_written():
    """The ends that a fault names are themselves taken."""
    remedy = faults(text(WIDE, case(TORQUE, "angle: 1 deg")))[0][2]
    low, high = remedy.removeprefix("write ").partition(", or")[0].split(" to ")
    for angle in (low, high):
        assert faults(text(WIDE, case(TORQUE, f"angle: {angle}"))) == []


def test_default_head_and_caps_count_in_the_length():
    """Without head and caps they follow the piston and the bore: 14 mm, and 22/4 = 5.5 mm."""
    head = "head:\n  material: al_7075_t6\n  length: 14 mm\n  clearance: 30 um\n"
    caps = "caps:\n  material: ti_6al4v\n  thickness: 8 mm\n"
    plain = text(linkage(300, 70), ONE).replace(head, "").replace(caps, "")
    assert "head:" not in plain
    assert "caps:" not in plain
    (fault,) = faults(plain)
    assert "193 mm to 303 mm" in fault[1]


def test_without_a_linkage_nothing_is_added():
    """Its metrics say why they are missing; no row and no warning is new."""
    found = ao.evaluate(ao.read(BENCH))
    for name in ("joint_torque_min", "joint_range", "geometry_dead_point", "geometry_joint_angle"):
        assert found.metrics[name].value is None
        assert found.metrics[name].why == "no linkage stated: add linkage"
    assert not any("torque[" in row.name for row in found.requirements)


def test_least_lever_arm_of_the_inertia_is_said():
    """The evaluation says what mass the inertia was taken for."""
    load = "load:\n  inertia: 0.05 kg*m^2\n"
    found = ao.evaluate(ao.read(text(WIDE, ONE, load=load)))
    weight = 0.05 / min(lever(0.245, 0.07, CLOSED), lever(0.245, 0.07, CLOSED + STROKE)) ** 2
    (said,) = [words for words in found.warnings if "inertia" in words]
    assert f"{weight:.4g} kg" in said


FULL = text(
    WIDE,
    case(TORQUE, "angle: 55 deg", "joint_speed: 30 rpm"),
    case("joint_torque: 0.1 kN*m", name="b", direction="pull"),
    load="load:\n  mass: 2 kg\n  inertia: 500 kg*cm^2\n",
    tail=RADII.partition("  load_cases")[0] + TAIL.removeprefix("variables:\n"),
)


def test_written_design_reads_back_bit_for_bit():
    """Edited text and text written anew give exactly the design."""
    actuator = ao.read(FULL)
    moved = actuator.changed({"linkage.crank_radius": 0.0700012345678, "load.inertia": 1 / 3e2})
    assert moved.design.linkage.crank_radius == 0.0700012345678
    assert moved.design.load_cases[0].joint_speed == pytest.approx(math.pi)
    for source in (actuator.source, None):
        assert ao.read(to_yaml(moved.design, source)).design == moved.design
    assert to_yaml(actuator.design, actuator.source) == FULL


def test_schema_offers_the_linkage():
    """Editor and reader take the same file; radii are offered as variables."""
    jsonschema = pytest.importorskip("jsonschema")
    yaml = pytest.importorskip("yaml")
    schema = json_schema()
    assert list(jsonschema.Draft7Validator(schema).iter_errors(yaml.safe_load(FULL))) == []
    assert "linkage.crank_radius" in schema["properties"]["variables"]["properties"]
    assert "joint_torque_min" in schema["properties"]["requirements"]["properties"]


def test_a_design_out_of_reach_is_never_met():
    """A least bad point may contradict itself: it is evaluated, and its torque is missed."""
    design = with_values(
        ao.read(text(WIDE, ONE)).design, {"linkage.base_radius": 0.30}, contradictions=False
    )
    found = ao.evaluate(design)
    row = next(row for row in found.requirements if row.name == "torque[a]")
    assert (row.value, row.met) == (None, False)
    assert found.metrics["geometry_dead_point"].value == pytest.approx(0.198 - 0.23)
    with pytest.raises(InputError):
        with_values(design, {"linkage.base_radius": 0.31})
