"""Scenario files: values in SI, every fault at its line, also those of the design they change."""

from __future__ import annotations

import io
import json
import math
import re
import sys
from functools import cache
from pathlib import Path

import pytest
import yaml
from hypothesis import given, strategies as st

from actuator_opt.base import quantities, units
from actuator_opt.base.errors import InputError
from actuator_opt.base.quantities import RESULTS, SCENARIOS
from actuator_opt.design.kinds import Fraction, ValueFault, example, read_quantity
from actuator_opt.design.scenario import Scenario, read_design_of, read_scenario
from actuator_opt.design.scenario.faults import cross_field, part_lists
from actuator_opt.design.scenario.kinds import SHAPES
from actuator_opt.design.schema import json_schema, quantity_schema
from actuator_opt.design.structure import entries

DESIGN = (Path(__file__).parents[2] / "designs" / "servo_knee.yaml").read_text("utf-8")

LOOP = """\
name: the loop under load
notes: >-
  A step of 10 mm,
  and a load that shakes it.
design: servo_knee.yaml
set:
  cylinder.bore: 25 mm
  load_cases[stance].force: 5 kN
duration: 2 s
sample_time: 1 ms
initial:
  position: 30 %
  pressure_a: 60 bar
  speed: -0.1 m/s
supply:
  type: fixed_pump
  volume: 0.5 l
  pump:
    displacement: 6.3 ml
    slip: 1.5e-7
    coulomb: 0.02
    viscous: 1e5
    shaft_speed: 1500 rpm
  relief:
    pressure: 210 bar
    rated_flow: 20 l/min
  accumulator:
    gas_volume: 0.3 l
    precharge: 120 bar
ends: valve
friction:
  coulomb: 80 N
  static: 120 N
  stribeck_speed: 8 mm/s
  viscous: 200 N*s/m
stops:
  damping: 0.4
  cushion:
    ends: cap
    length: 10 mm
    open_area: 0.5 cm^2
    end_area: 2 mm^2
load:
  force:
    - shape: constant
      value: -1 kN
    - shape: step
      start: 0.5 s
      value: 0
    - shape: ramp
      end: 0.5 s
      value: 10 N
    - shape: pulse
      start: 0.4 s
      end: 0.6 s
      value: 3 N
    - shape: sine
      value: 200 N
      frequency: 20 Hz
      phase: -90 deg
    - shape: record
      file: walk.csv
      column: force [N]
      scale: -1.5
  stiffness: 2 N/mm
  damping: 30 N*s/m
control:
  position:
    - shape: constant
      value: 30 mm
    - shape: step
      start: 0.1 s
      value: 10 mm
  law: pid
  tuning: stated
  position_gain: 700 V/m
  integral_time: 200 ms
  derivative_time: 5 ms
  pressure_feedback: 0.02 V/bar
  rate_limit: 500 V/s
analysis:
  window_cycles: 3
requirements:
  settling_time:
    max: 300 ms
  overshoot:
    min: 0
    max: 5 %
"""

MOTOR = """\
name: a motor
design: servo_knee.yaml
duration: 1 s
motor:
  machine:
    displacement: 13.3 ml
    slip: 1.5e-7
    coulomb: 0.16
    viscous: 1e5
    constant_torque: 0.1 N*m
  inertia: 133 kg*cm^2
  pipe_volume: 20 ml
  torque:
    - shape: step
      start: 0.5 s
      value: 10 N*m
control:
  shaft_speed:
    - shape: step
      value: 600 rpm
  shaft_speed_gain: 0.1 V*s/rad
  tuning: stated
"""

BENCH = """\
name: the valve alone
design: servo_knee.yaml
duration: 1 s
supply:
  type: controlled_pump
  volume: 1 l
  flow: 30 l/min
  gain: 2 l/min/bar
  time_constant: 20 ms
held_ports:
  pressure_a: 35 bar
  pressure_b: 35 bar
signal:
  - shape: ramp
    end: 1 s
    value: 10 V
"""

DRIVEN = """\
name: shaken from outside
design: servo_knee.yaml
duration: 1 s
ends: closed
friction:
  model: stribeck
load:
  drive:
    stiffness: 1000 N/mm
    position:
      - shape: sine
        frequency: 10 Hz
        value: 1 mm
"""

GOOD = {"loop": LOOP, "motor": MOTOR, "bench": BENCH, "driven": DRIVEN}


def changed(text, *pairs):
    """A text with parts replaced; each must occur once."""
    for old, new in pairs:
        assert text.count(old) == 1, old
        text = text.replace(old, new)
    return text


def faults(text, **options):
    """Every fault of a text."""
    with pytest.raises(InputError) as caught:
        read_scenario(text, **options)
    return caught.value.diagnostics


def place(text, part):
    """Line and column (from 1) where a part of the text stands."""
    assert text.count(part) == 1, part
    index = text.index(part)
    return text.count("\n", 0, index) + 1, index - (text.rfind("\n", 0, index) + 1) + 1


def test_values_are_si():
    """Units are converted once; what is not stated has its default."""
    loaded = read_scenario(LOOP)
    found = loaded.scenario
    assert found.set == {"cylinder.bore": "25 mm", "load_cases[stance].force": "5 kN"}
    assert (found.duration, found.sample_time) == (2.0, 1e-3)
    assert found.initial.position == Fraction(0.3)
    assert (found.initial.pressure_a, found.initial.pressure_b) == (60e5, None)
    assert found.initial.speed == -0.1
    pump = found.supply.pump
    assert pump.displacement == 6.3e-6
    assert pump.shaft_speed == pytest.approx(1500 * 2 * math.pi / 60, rel=1e-15)
    assert (pump.setting, pump.constant_torque) == (1.0, 0.0)
    assert found.supply.relief.override == 10e5
    assert found.stops.cushion.end_area == 2e-6
    shapes = [part.shape for part in found.load.force]
    assert shapes == ["constant", "step", "ramp", "pulse", "sine", "record"]
    sine, record = found.load.force[-2:]
    assert (sine.value, sine.frequency, sine.end) == (200.0, 20.0, None)
    assert sine.phase == pytest.approx(-math.pi / 2, rel=1e-15)
    assert (record.file, record.column, record.scale) == ("walk.csv", "force [N]", -1.5)
    assert found.control.pressure_feedback == pytest.approx(2e-7, rel=1e-15)
    assert found.control.derivative_time == 5e-3
    assert found.requirements["overshoot"].max == 0.05
    assert loaded.folder == Path()


@pytest.mark.parametrize("text", GOOD.values(), ids=GOOD)
def test_good_files_have_no_fault(text):
    """Loops, motors, valves on a bench and driven loads are read."""
    assert isinstance(read_scenario(text).scenario, Scenario)


SHORT = "name: x\ndesign: d.yaml\nduration: 1 s\n"
"""The least there is in a scenario."""


def test_least_scenario():
    """A name, a design and a duration are enough: nothing happens then."""
    found = read_scenario(SHORT).scenario
    assert (found.signal, found.control, found.sample_time) == ((), None, None)


ONE = [
    # base, change, part of the text where the fault stands, its path, message, remedy
    (LOOP, ("duration: 2 s", "duration: 0 s"), "0 s\nsample", "duration", "0 s: must be > 0",
     "write 1e-05 s to 100000 s"),
    (LOOP, ("duration: 2 s", "duration: -2 s"), "-2 s", "duration", "-2 s: must be > 0", "write"),
    (LOOP, ("duration: 2 s", "duration: 2"), "2\nsample", "duration", '"2": unit missing', '"2 s"'),
    (LOOP, ("duration: 2 s\n", ""), "name: the loop", "duration", "missing", 'add e.g. "duration'),
    (LOOP, ("design: servo_knee.yaml", 'design: "-"'), '"-"', "design", "is not a file",
     "knee.yaml"),
    (LOOP, ("position: 30 %", "position: worst"), "worst", "initial.position",
     "not an initial position",
     'write "50 %" or "55 mm"'),
    (LOOP, ("position: 30 %", "position: middle"), "middle", "initial.position", "not a number",
     'write "50 %" or "55 mm"'),
    (LOOP, ("position: 30 %", "position: 130 %"), "130 %", "initial.position", "outside", "100 %"),
    (LOOP, ("damping: 0.4", "dampin: 0.4"), "dampin: 0.4", "stops.dampin", "unknown key",
     'did you mean "damping"?'),
    (LOOP, ("  cylinder.bore: 25 mm", "  cylinder.bore: [25 mm]"), "[25 mm]", "set.cylinder.bore",
     "need a text, not a list", "write one value"),
    # parts of signals
    (LOOP, ("shape: ramp", "shape: rampe"), "rampe", "load.force[2].shape", "not a choice",
     'did you mean "ramp"?'),
    (LOOP, ("      end: 0.5 s\n", ""), "shape: ramp", "load.force[2].end",
     "missing: required by a ramp", 'add e.g. "end: 1 s"'),
    (LOOP, ("      end: 0.6 s\n", ""), "shape: pulse", "load.force[3].end",
     "missing: required by a pulse", 'add e.g. "end: 1 s"'),
    (LOOP, ("      value: -1 kN\n", ""), "shape: constant\n    - shape: step",
     "load.force[0].value", "missing: required by a constant", 'add e.g. "value: 1 N"'),
    (LOOP, ("      value: 200 N\n", ""), "shape: sine", "load.force[4].value",
     "missing: required by a sine", 'add e.g. "value: 1 N"'),
    (LOOP, ("      frequency: 20 Hz\n", ""), "shape: sine", "load.force[4].frequency",
     "missing: required by a sine", 'add e.g. "frequency: 20 Hz"'),
    (LOOP, ("      file: walk.csv\n", ""), "shape: record", "load.force[5].file",
     "missing: required by a record", 'add e.g. "file: record.csv"'),
    (LOOP, ("      column: force [N]\n", ""), "shape: record", "load.force[5].column",
     "missing: required by a record", 'add e.g. "column: force"'),
    (LOOP, ("      value: 0\n", "      value: 0\n      frequency: 5 Hz\n"), "frequency: 5 Hz",
     "load.force[1].frequency", "without effect on a step", "remove the line"),
    (LOOP, ("      value: 0\n", "      value: 0\n      end: 1 s\n"), "end: 1 s",
     "load.force[1].end", "without effect on a step", 'or write "shape: pulse"'),
    (LOOP, ("      value: -1 kN\n", "      value: -1 kN\n      start: 1 s\n"), "start: 1 s",
     "load.force[0].start", "without effect on a constant", 'or write "shape: step"'),
    (LOOP, ("      scale: -1.5", "      value: 3 N"), "value: 3 N\n  stiff",
     "load.force[5].value", "without effect on a record", "remove the line"),
    (LOOP, ("      phase: -90 deg", "      scale: 2"), "scale: 2", "load.force[4].scale",
     "without effect on a sine", "remove the line"),
    (LOOP, ("    end: 0.6 s", "    end: 0.4 s"), "0.4 s\n      value: 3 N", "load.force[3].end",
     "0.4 s: not after start (0.4 s)", "write more than 0.4 s"),
    (LOOP, ("      end: 0.5 s", "      end: 0 s"), "0 s\n      value: 10 N", "load.force[2].end",
     "0 s: not after start (0 s)", "write more than 0 s"),
    (LOOP, ("start: 0.5 s", "start: 2 s"), "2 s\n      value: 0", "load.force[1].start",
     "2 s: not before the scenario ends (2 s)", "write less than 2 s, or raise duration"),
    (LOOP, ("start: 0.5 s", "start: -1 s"), "-1 s\n", "load.force[1].start", "must be >= 0", "0 s"),
    (DRIVEN, ("      - shape: sine\n        frequency: 10 Hz\n        value: 1 mm\n", "      []\n"),
     "[]", "load.drive.position", "the list is empty", "add one"),
    (BENCH, ("  - shape: ramp\n    end: 1 s\n    value: 10 V", "  shape: ramp"), "shape: ramp",
     "signal", "need a list, not a block of keys", 'start each entry with "- "'),
    (BENCH, ("value: 10 V", "value: 10 mm"), "10 mm", "signal[0].value",
     "mm is a length, need a voltage", "use one of V, mV"),
    # time
    (LOOP, ("sample_time: 1 ms", "sample_time: 10 ms"), "10 ms", "sample_time",
     "sample time too coarse: 20 Hz needs 5 ms or less", "write 5 ms"),
    (LOOP, ("sample_time: 1 ms", "sample_time: 0.5 us"), "0.5 us", "sample_time",
     "gives more than 2 million samples", "write at least 0.001 ms, or shorten duration"),
    (LOOP, ("sample_time: 1 ms", "sample_time: 0.3 s"), "0.3 s", "sample_time",
     "300 ms: gives fewer than 10 samples in 2 s", "write at most 200 ms"),
    (DRIVEN, ("duration: 1 s", "duration: 30 s"), "10 Hz", "load.drive.position[0].frequency",
     "sample time too coarse: 10 Hz needs 10 ms or less", 'add "sample_time: 10 ms"'),
    (DRIVEN, ("duration: 1 s", "duration: 100000 s"), "10 Hz", "load.drive.position[0].frequency",
     "a sine of 10 Hz during 100000 s would need more than 2 "
     "million samples", "lower the frequency, or shorten duration"),
    # control
    (LOOP, ("  law: pid", "  speed:\n    - shape: step\n      value: 1 m/s\n  law: pid"),
     "speed:\n    - shape", "control.speed", "a second reference, beside position", "keep one"),
    (MOTOR, ("  shaft_speed:\n    - shape: step\n      value: 600 rpm\n", ""), "control",
     "control.position", "missing: no reference",
     'add a list "position:" (or speed, shaft_speed, shaft_angle)'),
    (MOTOR, ("    - shape: step\n      value: 600 rpm", "    []"), "control", "control.position",
     "missing: no reference", "add a list"),
    (LOOP, ("  position_gain: 700 V/m", "  speed_gain: 7 V*s/m\n  position_gain: 7 V/m"),
     "speed_gain", "control.speed_gain", "this is the gain of a speed loop",
     "write position_gain"),
    (LOOP, ("  position_gain: 700 V/m\n", ""), "control:", "control.position_gain",
     "missing: required by stated tuning", 'add e.g. "position_gain: '),
    (LOOP, ("  integral_time: 200 ms\n", ""), "control:", "control.integral_time",
     "missing: required by a stated pid law", 'add e.g. "integral_time: '),
    (LOOP, ("  derivative_time: 5 ms\n", ""), "control:", "control.derivative_time",
     "missing: required by a stated pid law", 'add e.g. "derivative_time: '),
    (LOOP, ("  law: pid", "  law: pi"), "derivative_time", "control.derivative_time",
     "without effect on a pi law", "remove the line"),
    (MOTOR, ("  tuning: stated", "  tuning: stated\n  integral_factor: 2"), "integral_factor",
     "control.integral_factor", "without effect on a p law", "remove the line"),
    (MOTOR, ("  tuning: stated", "  tuning: stated\n  margin: 2"), "margin",
     "control.margin", "without effect where tuning is stated", "remove the line"),
    (MOTOR, ("  tuning: stated", "  tuning: stated\n  pressure_time: 20 ms"), "pressure_time",
     "control.pressure_time", "without effect without pressure_feedback", "remove the line"),
    (LOOP, ("  tuning: stated", "  tuning: ziegler_nichols"), "position_gain",
     "control.position_gain", "stated, although tuning (ziegler_nichols) calculates it",
     'remove it, or write "tuning: stated"'),
    (MOTOR, ("  tuning: stated", "  law: p"), "shaft_speed_gain", "control.shaft_speed_gain",
     "stated, although tuning (margins) calculates it", 'remove it, or write "tuning: stated"'),
    (LOOP, ("ends: valve\n", "ends: valve\nsignal:\n  - {shape: step, value: 1 V}\n"), "signal:",
     "signal", "both signal and control are stated", "keep one of them"),
    # motor and held ports
    (SHORT, ("1 s\n", "1 s\ncontrol:\n  shaft_angle:\n    - {shape: step, value: 9 deg}\n"),
     "shaft_angle", "control.shaft_angle", "without a motor there is no shaft",
     "add motor, or write position or speed"),
    (MOTOR, ("  shaft_speed:\n    - shape: step\n      value: 600 rpm\n"
             "  shaft_speed_gain: 0.1 V*s/rad", "  speed:\n    - shape: step\n      value: 1 m/s\n"
             "  speed_gain: 1 V*s/m"), "speed:", "control.speed", "there is no rod to move",
     "write shaft_speed or shaft_angle, or remove motor"),
    (MOTOR, ("motor:\n", "stops:\n  damping: 1\nmotor:\n"), "stops", "stops",
     "without effect with a motor in place of the cylinder", "remove the line"),
    (MOTOR, ("motor:\n", "initial:\n  position: 5 mm\nmotor:\n"), "position: 5 mm",
     "initial.position", "without effect with a motor", "remove the line"),
    (MOTOR, ("motor:\n", "load:\n  drive:\n    stiffness: 1 N/mm\n    position:\n"
             "      - {shape: step, value: 1 mm}\nmotor:\n"), "drive", "load.drive",
     "without effect with a motor", 'state the motor\'s load in the block "motor:"'),
    (MOTOR, ("motor:\n", "held_ports:\n  pressure_a: 3 bar\n  pressure_b: 0\nmotor:\n"),
     "held_ports", "held_ports", "with both held_ports and motor", "keep one of them"),
    (BENCH, ("signal:\n", "load:\n  damping: 3 N*s/m\nsignal:\n"), "damping", "load.damping",
     "without effect with held ports", "remove the line"),
    (BENCH, ("signal:\n  - shape: ramp\n    end: 1 s\n    value: 10 V", "control:\n  position:\n"
             "    - {shape: step, value: 1 mm}"), "control:", "control",
     "without effect with held ports", "remove it, or remove held_ports"),
    (BENCH, ("held_ports:\n  pressure_a: 35 bar\n", "held_ports:\n"), "held_ports",
     "held_ports.pressure_a", "missing", 'add e.g. "pressure_a: 2 bar"'),
    # ends
    (LOOP, ("ends: valve", "ends: valves"), "valves", "ends", "not a choice",
     'did you mean "valve"?'),
    (MOTOR, ("duration: 1 s", "duration: 1 s\nends: closed"), "closed", "ends",
     "closed: the control would drive a valve that is not connected",
     'write "valve", or remove control'),
    (BENCH, ("held_ports:\n  pressure_a: 35 bar\n  pressure_b: 35 bar\nsignal:\n  - shape: ramp\n"
             "    end: 1 s\n    value: 10 V\n", "ends: reducing_valve\n"), "reducing_valve", "ends",
     "reducing_valve: the pump of the supply is not connected",
     'write "valve", or remove supply'),
    # supply
    (LOOP, ("  volume: 0.5 l\n", ""), "supply:", "supply.volume",
     "missing: required by a fixed_pump", 'add e.g. "volume: '),
    (LOOP, ("  relief:\n    pressure: 210 bar\n    rated_flow: 20 l/min\n", ""), "supply:",
     "supply.relief", "missing: required by a fixed_pump", 'add a block "relief:" with pressure'),
    (LOOP, ("  volume: 0.5 l", "  volume: 0.5 l\n  flow: 9 l/min"), "pump:\n    disp",
     "supply.pump", "both pump and flow are stated", "keep one of them"),
    (LOOP, ("  pump:\n    displacement: 6.3 ml\n    slip: 1.5e-7\n    coulomb: 0.02\n"
            "    viscous: 1e5\n    shaft_speed: 1500 rpm\n", ""), "supply:", "supply.flow",
     "missing: a fixed_pump needs flow or pump", 'or a block "pump:"'),
    (LOOP, ("  volume: 0.5 l", "  volume: 0.5 l\n  gain: 9 l/min/bar"), "gain: 9", "supply.gain",
     "without effect on a fixed_pump", "remove the line"),
    (BENCH, ("  flow: 30 l/min\n", ""), "supply:", "supply.flow",
     "missing: required by a controlled_pump", 'add e.g. "flow: 10 l/min"'),
    (BENCH, ("  gain: 2 l/min/bar\n", ""), "supply:", "supply.gain",
     "missing: required by a controlled_pump", 'add e.g. "gain: '),
    (BENCH, ("  time_constant: 20 ms\n", ""), "supply:", "supply.time_constant",
     "missing: required by a controlled_pump", 'add e.g. "time_constant: '),
    (BENCH, ("  volume: 1 l\n", ""), "supply:", "supply.volume",
     "missing: required by a controlled_pump", 'add e.g. "volume: '),
    (MOTOR, ("motor:\n", "supply:\n  relief:\n    pressure: 9 bar\n    rated_flow: 9 l/min\n"
             "motor:\n"), "relief", "supply.relief", "without effect on a constant supply",
     "remove it, or write another type"),
    (MOTOR, ("motor:\n", "supply:\n  accumulator:\n    gas_volume: 9 ml\n    precharge: 9 bar\n"
             "motor:\n"), "accumulator", "supply.accumulator",
     "without effect on a constant supply", "remove it, or write another type"),
    # cushion and friction
    (LOOP, ("end_area: 2 mm^2", "end_area: 0.5 cm^2"), "0.5 cm^2\nload", "stops.cushion.end_area",
     "0.5 cm^2: not smaller than open_area (0.5 cm^2)", "write less than 0.5 cm^2"),
    (LOOP, ("static: 120 N", "static: 70 N"), "70 N", "friction.static",
     "70 N: below coulomb (80 N)", "write 80 N or more"),
    (LOOP, ("  coulomb: 80 N\n", ""), "friction", "friction.coulomb", "missing: required "
                                                                      "with static",
     'add e.g. "coulomb: '),
    (DRIVEN, ("stribeck\n", "stribeck\n  viscous: 9 N*s/m\n"), "friction", "friction.coulomb",
     "missing: required with viscous", 'add e.g. "coulomb: '),
    (LOOP, ("  stribeck_speed: 8 mm/s\n", ""), "friction", "friction.stribeck_speed",
     "missing: required with static", 'add e.g. "stribeck_speed: 5 mm/s"'),
    (DRIVEN, ("stribeck\n", "stribeck\n  bristle_travel: 9 um\n"), "bristle_travel",
     "friction.bristle_travel", "without effect where model is stribeck", "remove the line"),
    (DRIVEN, ("stribeck\n", "none\n  coulomb: 9 N\n"), "coulomb", "friction.coulomb",
     "without effect where model is none", "remove the line"),
    # requirements
    (LOOP, ("  settling_time:", "  setling_time:"), "setling_time", "requirements.setling_time",
     "is not a metric", 'did you mean "settling_time"?'),
    (LOOP, ("  settling_time:", "  mass:"), "mass", "requirements.mass", "is not a metric", "use"),
    (LOOP, ("max: 300 ms", "max: 300 mm"), "300 mm", "requirements.settling_time.max",
     "mm is a length, need a time", "use one of ms"),
    (LOOP, ("    max: 5 %", "    max: -5 %"), "-5 %", "requirements.overshoot.max", ">= 0", "0 %"),
    (DRIVEN, ("load:\n", "requirements:\n  rise_time:\n    max: 9 ms\nload:\n"), "rise_time",
     "requirements.rise_time", "the reference has no step",
     'add a part "shape: step" to control with a reference'),
]  # fmt: skip


@pytest.mark.parametrize(
    ("base", "change", "part", "path", "message", "remedy"),
    ONE,
    ids=[f"{row[3]}-{number}" for number, row in enumerate(ONE)],
)
def test_one_fault(base, change, part, path, message, remedy):
    """Each slip gives one line: its place, its PATH, what is wrong and what to do."""
    text = changed(base, change)
    (fault,) = faults(text)
    assert fault.path == path
    assert (fault.line, fault.column) == place(text, part)
    assert message in fault.message
    assert remedy in fault.remedy


def test_every_fault_in_one_pass():
    """The faults of a bad file come together, in the order of its lines."""
    text = changed(
        LOOP,
        ("duration: 2 s", "duration: 2 bar"),
        ("  type: fixed_pump", "  type: fixed_pump\n  gain: 3 mm"),
        ("shape: pulse", "shape: puls"),
        ("  position_gain: 700 V/m\n", ""),
        ("  overshoot:", "  overshot:"),
    )
    found = faults(text)
    assert [fault.path for fault in found] == [
        "duration", "supply.gain", "supply.gain", "load.force[3].shape", "control.position_gain",
        "requirements.overshot",
    ]  # fmt: skip
    assert [fault.line for fault in found] == sorted(fault.line for fault in found)


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("key", ["value", "start", "end", "frequency", "phase", "file", "column"])
def test_each_key_of_a_shape_is_needed_read_or_refused(shape, key):
    """A key that a shape needs or reads is taken, any other is refused: none is passed over."""
    good = {
        "value": "1 N", "start": "0.1 s", "end": "0.2 s", "frequency": "5 Hz", "phase": "3 deg",
        "file": "a.csv", "column": "f", "scale": "2",
    }  # fmt: skip
    needs = SHAPES[shape]
    stated = {one: good[one] for one in (*needs.needed, key)}
    lines = "".join(f"      {one}: {value}\n" for one, value in stated.items())
    text = f"{SHORT}load:\n  force:\n    - shape: {shape}\n{lines}"
    if key in (*needs.needed, *needs.read):
        assert len(read_scenario(text).scenario.load.force) == 1
        return
    (fault,) = faults(text)
    assert fault.path == f"load.force[0].{key}"
    assert (fault.line, fault.column) == place(text, f"{key}: {good[key]}")


def test_every_signal_is_checked():
    """The parts of every list of signals are checked alike."""
    assert [".".join(loc) for loc in part_lists()] == [
        "motor.torque", "load.force", "load.torque", "load.drive.position", "load.cylinder.signal",
        "signal",
        "control.position", "control.speed", "control.shaft_speed", "control.shaft_angle",
        "control.feed_forward",
    ]  # fmt: skip
    for loc in part_lists():
        tree = leaf = {}
        for key in loc[:-1]:
            leaf[key] = leaf = {}
        leaf[loc[-1]] = [{"shape": "ramp", "value": 1.0}]
        found = [fault.loc for fault in cross_field(tree)]
        assert (*loc, 0, "end") in found


@pytest.mark.parametrize("frequency", [0.7, 1.5, 3.0, 7.0, 11.0, 13.0, 29.0, 31.3, 99.9])
@pytest.mark.parametrize("duration", [1, 7, 30])
def test_a_remedy_for_the_sample_time_mends_it(frequency, duration):
    """The sample time a fault names is taken: it is rounded to the safe side."""
    text = DRIVEN.replace("10 Hz", f"{frequency} Hz").replace("1 s", f"{duration} s")
    for stated in ("", f"sample_time: {duration / 12:.4g} s\n", "sample_time: 2e-3 us\n"):
        try:
            read_scenario(text + stated)
        except InputError as error:
            (fault,) = error.diagnostics
            good = re.search(r"[\d.e-]+ ms", fault.remedy)[0]
            assert read_scenario(f"{text}sample_time: {good}\n")


@pytest.mark.parametrize("name", ["rise_time", "settling_time", "overshoot", "steady_state_ratio"])
def test_one_step_answers_step_requirements(name):
    """Constants and more parts beside a step are fine; a sine beside it leaves no step."""
    text = f"{SHORT}control:\n  position:\n    - {{shape: step, value: 3 mm}}\n"
    limit = f"requirements:\n  {name}:\n    max: 0\n"
    assert read_scenario(text + limit).scenario.requirements[name].max == 0.0
    constant = "    - {shape: constant, value: 3 mm}\n"
    assert read_scenario(text + constant + limit)
    for more in ("step, value: 1 mm, start: 0.5 s", "ramp, value: 1 mm, end: 1 s"):
        assert read_scenario(f"{text}    - {{shape: {more}}}\n{limit}")
    sine = "sine, value: 1 mm, frequency: 5 Hz"
    (fault,) = faults(f"{text}    - {{shape: {sine}}}\n{limit}")
    assert fault.path == f"requirements.{name}"
    assert "the reference has no step" in fault.message


def test_a_design_is_no_scenario():
    """Files of the other kind are refused in one line that says so."""
    (fault,) = faults(DESIGN)
    assert fault.message == "the file is a design, not a scenario"
    assert (fault.line, fault.column) == place(DESIGN, "cylinder:\n")
    from actuator_opt.design import read_design

    with pytest.raises(InputError) as caught:
        read_design(SHORT)
    (fault,) = caught.value.diagnostics
    assert (fault.message, fault.line) == ("the file is a scenario, not a design", 2)


BAD_YAML = [
    ("name: x\nname: y\ndesign: d.yaml\nduration: 1 s\n", 2, 1, "duplicate key"),
    ("name: x\n\tdesign: d\n", 2, 1, "tab"),
    (SHORT + "signal:\n  - shape: step\n   value: 1 V\n", 6, None, ""),
    (SHORT + "signal: [1, 2\n", 4, 9, "bracket is not closed"),
    (SHORT + "signal: &a []\n", 4, 9, "anchor"),
    (SHORT + "signal: *a\n", 4, 9, "alias"),
    (SHORT + "signal: !!set {}\n", 4, 9, "tag"),
    (SHORT + "--- \nname: x\n", 4, 1, "a second document"),
    (SHORT + "? [a]\n: b\n", 4, 3, "a key must be one word"),
    (SHORT + "<<: 3\n", 4, 1, "merge keys"),
    (SHORT + "notes: 'x\n", 4, 8, "quote"),
    (SHORT + "signal:\n", 4, 8, "no value"),
    (SHORT + "notes: a\x00b\n", 4, 9, "control character"),
    ("\n\n", 1, 1, "the file is empty"),
    ("- a\n- b\n", 1, 1, "not a scenario"),
]


@pytest.mark.parametrize(("text", "line", "column", "message"), BAD_YAML)
def test_malformed_yaml_has_its_place(text, line, column, message):
    """What is no YAML, or more than a person needs of it, is refused at its place."""
    fault = faults(text)[0]
    assert fault.line == line, str(fault)
    assert column is None or fault.column == column, str(fault)
    assert message in fault.message
    assert fault.remedy


ABSURD = [
    ("duration", "1e300 s"), ("duration", ".nan"), ("duration", "1e-300 s"), ("duration", "nan s"),
    ("duration", "inf s"), ("duration", "1e999 s"), ("duration", "9" * 99 + " s"),
    ("duration", "1:30"), ("duration", "0x10 s"), ("duration", "1,5 s"), ("duration", "1 s s"),
    ("sample_time", "1e-300 ms"), ("sample_time", "0 ms"), ("sample_time", "1e300 h"),
    ("sample_time", "-0 s"), ("sample_time", "1e-9 us"), ("design", ""), ("design", "'  '"),
    ("name", "''"), ("ends", "yes"), ("signal", "5 V"),
]  # fmt: skip


@pytest.mark.parametrize(("key", "value"), ABSURD)
def test_absurd_values(key, value):
    """Numbers out of any sense and empty texts are one fault at their line."""
    text = "".join(line for line in SHORT.splitlines(True) if not line.startswith(key))
    text = f"{text}{key}: {value}\n"
    (fault,) = faults(text)
    assert (fault.path, fault.line) == (key, text.count("\n"))
    assert fault.remedy


def test_long_lists_are_refused_quickly():
    """More parts than fit are one fault, beside at most a hundred others."""
    (fault,) = faults(SHORT + "signal:\n" + "  - {shape: step, value: 1 V}\n" * 101)
    assert fault.message == "too many entries"
    found = faults(SHORT + "signal:\n" + "  - {shape: ramp}\n" * 5000)
    assert len(found) == 101


# --- together with the design


@pytest.fixture
def folder(tmp_path):
    """A folder with the servo knee in it."""
    (tmp_path / "servo_knee.yaml").write_text(DESIGN, "utf-8")
    return tmp_path


def both(folder, text, *, design=None, **options):
    """Scenario and design, read from files of a folder."""
    if design is not None:
        (folder / "servo_knee.yaml").write_text(design, "utf-8")
    file = folder / "run.yaml"
    file.write_text(text, "utf-8")
    loaded = read_scenario(file, **options)
    return loaded, read_design_of(loaded)


def together(folder, text, **options):
    """Every fault of both."""
    with pytest.raises(InputError) as caught:
        both(folder, text, **options)
    return caught.value.diagnostics


def test_the_design_lies_beside_the_scenario(folder, monkeypatch):
    """The design is found from the scenario's folder on, wherever the command runs."""
    loaded, design = both(folder, LOOP)
    assert loaded.folder == folder
    assert loaded.design_file == folder / "servo_knee.yaml"
    assert design.design.cylinder.bore == 0.025
    assert design.design.load_cases[0].force == 5000.0
    monkeypatch.chdir(folder)
    assert read_design_of(read_scenario("run.yaml")).design == design.design
    assert read_design_of(read_scenario(LOOP)).design == design.design
    monkeypatch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO(LOOP.encode())))
    assert read_design_of(read_scenario("-")).design == design.design


SET = [
    ("  cylinder.bore: 25 mm", "  cylinder.bore: 25 bar", "25 bar", "cylinder.bore", "need a len"),
    ("  cylinder.bore: 25 mm", "  cylinder.bore: 25", "25\n", "cylinder.bore", "unit missing"),
    ("  cylinder.bore: 25 mm", "  cylinder.bore: 60 mm", "60 mm", "cylinder.bore",
     "start value outside the bounds"),
    ("  cylinder.bore: 25 mm", "  cylinder.bor: 25 mm", "cylinder.bor:", "cylinder.bor",
     "unknown PATH"),
    ("  cylinder.bore: 25 mm", "  ports.end: shut", "shut", "ports.end", "not a choice"),
    ("  cylinder.bore: 25 mm", "  rod.inner_diameter: 13 mm", "13 mm", "rod.inner_diameter",
     "must be smaller than rod.outer_diameter"),
    ("  cylinder.bore: 25 mm", "  rod.material: steel", "steel", "rod.material", "unknown mater"),
    ("  cylinder.bore: 25 mm", "  cylinder: 3", "cylinder: 3", "cylinder", "names a block"),
    ("  load_cases[stance].force: 5 kN", "  load_cases[jump].force: 5 kN", "load_cases[jump]",
     "load_cases[jump].force", "no entry jump"),
    ("  cylinder.bore: 25 mm", "  load_cases[0].force: 5 kN", "load_cases[stance]",
     "load_cases[stance].force", "is also set as load_cases[0].force"),
    ("  cylinder.bore: 25 mm", "  ports.throttle.area: 1 cm^2", "1 cm^2",
     "ports.throttle.check_area", "missing"),
]  # fmt: skip


@pytest.mark.parametrize(("old", "new", "part", "path", "message"), SET)
def test_faults_of_set_stand_in_the_scenario(folder, old, new, part, path, message):
    """A changed value that does not fit the design is shown where the scenario states it."""
    text = changed(LOOP, (old, new))
    fault = together(folder, text)[0]
    assert fault.file == str(folder / "run.yaml")
    assert (fault.line, fault.column) == place(text, part)
    assert fault.path == path
    assert message in fault.message
    assert fault.source == text.splitlines()[fault.line - 1]


def test_faults_of_both_files(folder):
    """The scenario's come first, the design's own keep their lines."""
    text = changed(LOOP, ("  cylinder.bore: 25 mm", "  cylinder.bore: 25 bar"))
    broken = changed(DESIGN, ("  stroke: 110 mm", "  stroke: 110"))
    first, second = together(folder, text, design=broken)
    assert (first.file, first.path) == (str(folder / "run.yaml"), "cylinder.bore")
    assert (second.file, second.path) == (str(folder / "servo_knee.yaml"), "cylinder.stroke")
    assert second.line == place(broken, "stroke: 110\n")[0]


def test_a_design_that_is_not_there(folder):
    """The fault of a design file as a whole stands where the scenario names it."""
    text = changed(LOOP, ("design: servo_knee.yaml", "design: servo_kne.yaml"))
    (fault,) = together(folder, text)
    assert (fault.line, fault.column) == place(text, "servo_kne.yaml")
    assert fault.path == "design"
    assert "no such file" in fault.message
    assert "servo_knee.yaml" in fault.remedy
    text = changed(LOOP, ("design: servo_knee.yaml", "design: ."))
    (fault,) = together(folder, text)
    assert fault.path == "design"
    text = changed(LOOP, ("design: servo_knee.yaml", "design: run.yaml"))
    (fault,) = together(folder, text)
    assert fault.message == "the file is a scenario, not a design"


def test_command_line_values_find_their_file(folder):
    """A PATH the scenario has is the scenario's, else the design's; a bare number is SI."""
    values = {
        "duration": "1", "control.position_gain": "500 V/m", "supply.pressure": "150e5",
        "load.mass": "30", "load.stiffness": "2e3", "requirements.overshoot.max": "0.1",
        "requirements.leakage.max": "400 ml/min", "set.cylinder.bore": "0.026",
        "valve.rated_flow": "20 l/min", "load.force[1].value": "7",
    }  # fmt: skip
    loaded, read = both(folder, LOOP, overrides=values.items())
    scenario, design = loaded.scenario, read.design
    assert (scenario.duration, scenario.control.position_gain) == (1.0, 500.0)
    assert scenario.load.stiffness == 2e3
    assert scenario.load.force[1].value == 7.0
    assert scenario.requirements["overshoot"].max == 0.1
    assert (design.supply.pressure, design.load.mass) == (150e5, 30.0)
    assert design.cylinder.bore == 0.026
    assert design.requirements["leakage"].max == pytest.approx(400e-6 / 60)
    assert design.valve.rated_flow == pytest.approx(20e-3 / 60)
    loaded, read = both(folder, LOOP, overrides=[("cylinder.bore", "0.027")])
    assert read.design.cylinder.bore == 0.027  # comes after the scenario's own


REMOVED = """\
unset:
  - seals.piston.back_up
  - seals.piston.back_up_material
  - seals.piston.back_up_thickness
  - load_cases[stance].side_load
  - requirements.stiffness_min
"""


def test_keys_of_the_design_that_a_scenario_removes(folder):
    """They take their defaults, before `set` and the command line set values."""
    before = both(folder, LOOP)[1].design
    assert before.seals.piston.back_up != "none"
    assert before.load_cases[0].side_load == 30
    assert "stiffness_min" in before.requirements
    text = LOOP.replace("set:\n", REMOVED + "set:\n  requirements.stiffness_min.max: 9 kN/mm\n")
    after = both(folder, text)[1].design
    assert after.seals.piston.back_up == "none"
    assert after.load_cases[0].side_load == 0
    limit = after.requirements["stiffness_min"]
    assert (limit.min, limit.max) == (None, pytest.approx(9e6))
    rings = {"back_up": "one", "back_up_material": "back_up_ptfe", "back_up_thickness": "1.2 mm"}
    again = both(folder, text, overrides=[(f"seals.piston.{k}", x) for k, x in rings.items()])
    assert again[1].design.seals.piston.back_up == "one"


@pytest.mark.parametrize(
    ("line", "message", "remedy"),
    [
        ("valve.offset", "is not stated, so it cannot be unset", "remove this entry"),
        ("cylinder.stroke", "cannot be unset: it is required", "set it instead"),
        ("cushionn", "unknown PATH", 'did you mean "cushion"?'),
        ("'barrel.layup[0]'", "an entry of a list cannot be unset", "change it in the file"),
        ("seals.piston.back_up", "without it, seals.piston.back_up_material and seals.piston."
         "back_up_thickness have no meaning", 'to the list "unset" of the scenario'),
    ],
)  # fmt: skip
def test_what_a_scenario_cannot_remove(folder, line, message, remedy):
    """One line at the entry of the list, with place and remedy."""
    text = LOOP.replace("set:\n", f"unset:\n  - {line}\nset:\n")
    (fault,) = together(folder, text)
    assert fault.file.endswith("run.yaml")
    assert (fault.line, fault.column) == place(text, line)
    assert message in fault.message
    assert remedy in fault.remedy


@pytest.mark.parametrize(
    ("path", "value", "near"),
    [
        ("control.position_gian", "3", "control.position_gain"),
        ("duraton", "3", "duration"),
        ("duration", "3 mm", "s"),
        ("load.force[9].value", "3 N", "use one of 0, 1"),
        ("cylinder.bor", "3 mm", "cylinder.bore"),
        ("cylinder.bore", "3 bar", "mm"),
        ("set.cylinder.bor", "3 mm", "cylinder.bore"),
    ],
)
def test_bad_command_line_values_name_set(folder, path, value, near):
    """Their faults name --set, in whichever of the files the PATH belongs."""
    fault = together(folder, LOOP, overrides=[(path, value)])[0]
    assert (fault.file, fault.line) == ("--set", None)
    assert fault.path == path.removeprefix("set.")
    assert near in fault.remedy


NO_VALVE = changed(
    DESIGN,
    (DESIGN[DESIGN.index("valve:  ") : DESIGN.index("load:\n  mass")], ""),
    ("  control.gain:\n    lower: 10 V/m\n    upper: 20000 V/m\n", ""),
    (DESIGN[DESIGN.index("  bandwidth:") : DESIGN.index("  dynamic_stiffness:")], ""),
)


def test_what_needs_a_valve(folder):
    """A signal, a loop, held ports, a motor, a pump and the end named valve need one."""
    step = "  - {shape: step, value: 1 V}\n"
    texts = {
        "signal": f"{SHORT}signal:\n{step}",
        "control": f"{SHORT}control:\n  position:\n    - {{shape: step, value: 1 mm}}\n",
        "held_ports": BENCH[: BENCH.index("supply")] + BENCH[BENCH.index("held") :],
        "motor": MOTOR[: MOTOR.index("control")],
        "ends": f"{SHORT}ends: valve\n",
        "supply.type": BENCH[: BENCH.index("held")],
    }
    for path, text in texts.items():
        text = text.replace("d.yaml", "servo_knee.yaml")
        fault = together(folder, text, design=NO_VALVE)[0]
        expected = "signal" if path == "held_ports" else path
        assert fault.path == expected
        assert fault.message == "the design has no valve"
        assert "add valve to the design" in fault.remedy
        assert fault.line == place(text, expected.split(".")[-1] + ":")[0]
        assert both(folder, text, design=DESIGN)
    assert both(folder, DRIVEN, design=NO_VALVE)


def test_a_scenario_that_does_not_fit_its_design(folder):
    """What the design does not describe, and places beyond its stroke."""
    text = changed(DRIVEN, ("ends: closed", "ends: reducing_valve"))
    (fault,) = together(folder, text)
    assert (fault.path, fault.message) == (
        "ends",
        "reducing_valve: the design has no reducing valve",
    )
    assert (fault.line, fault.column) == place(text, "reducing_valve")
    text = changed(DRIVEN, ("load:\n", "load:\n  torque:\n    - {shape: step, value: 9 N*m}\n"))
    (fault,) = together(folder, text)
    assert (fault.path, fault.message) == ("load.torque", "the design has no linkage")
    assert (fault.line, fault.column) == place(text, "torque")
    linked = DESIGN + "linkage:\n  base_radius: 250 mm\n  crank_radius: 70 mm\n"
    assert both(folder, text, design=linked)[0].scenario.load.torque[0].value == 9.0
    text = changed(
        LOOP, ("position: 30 %", "position: 111 mm"), ("length: 10 mm", "length: 120 mm")
    )
    first, second = together(folder, text)
    assert (first.path, first.message) == (
        "initial.position", "111 mm: beyond cylinder.stroke (110 mm)"
    )  # fmt: skip
    assert (second.path, second.message) == (
        "stops.cushion.length", "120 mm: beyond cylinder.stroke (110 mm)"
    )  # fmt: skip
    assert (second.line, second.column) == place(text, "120 mm")


def test_faults_found_later_have_their_place():
    """A fault of a PATH, of a block or of a requirement is found in the text."""
    loaded = read_scenario(LOOP)
    for path, part in {
        "load.force[5].file": "walk.csv",
        "requirements.settling_time.max": "300 ms",
        "set.cylinder.bore": "25 mm",
        "control.derivative_factor": "control:",
    }.items():
        fault = loaded.diagnostic(path, "is bad")
        assert (fault.line, fault.column) == place(LOOP, part), path


# --- whatever the file

LINES = LOOP.splitlines(keepends=True)
CODE = [index for index, line in enumerate(LINES) if ":" in line]
ODD = [
    "", "~", "no", "{}", "[]", "[1, 2]", "{a: b}", "&x 1", "*x", "!!int 3", "-1 mm", "0", "0 s",
    "1e300 s", "-1e300", "1e-300 ms", ".nan", ".inf s", "1e999 s", "12:30", '"unclosed', "|", ">-",
    "- a", "a: b", "1" * 200, "%", "@", "\t25 mm", "worst", "50 %", "1 V", "20 Hz", "3 bar", "pi",
    "record", "closed", "controlled_pump", '"\\x1b[2J"', '"\\ud800"', "x" * 300, "-3 N", "1 ms",
    "5 l/min", "[{shape: sine, value: 1 N, frequency: 100 kHz}]", "{shape: step}", "false",
]  # fmt: skip
KEYS = sorted(
    set(entries(Scenario))
    | {"shape", "value", "frequency", "start", "end", "file", "column", "position", "speed", "law"}
    | {
        "tuning",
        "type",
        "pump",
        "relief",
        "cushion",
        "machine",
        "max",
        "rise_time",
        "cylinder.bore",
    }
)


def outcome(text, **options):
    """A scenario, or its faults: they have the file, and print as one line each."""
    found = None
    try:
        read_scenario(text + "\n", **options)
    except InputError as error:
        found = error.diagnostics
    assert found is None or found
    for fault in found or ():
        assert fault.file is not None
        assert str(fault).splitlines()[0].isprintable()
        assert fault.message


@given(st.lists(st.tuples(st.sampled_from(CODE), st.sampled_from(ODD)), min_size=1, max_size=4))
def test_odd_values(changes):
    """Any value replaced by any odd one."""
    lines = list(LINES)
    for index, odd in changes:
        lines[index] = f"{lines[index].split(':')[0]}: {odd}\n"
    outcome("".join(lines))


@given(st.lists(st.tuples(st.sampled_from(CODE), st.sampled_from(KEYS)), min_size=1, max_size=4))
def test_odd_keys(changes):
    """Any key replaced by any other."""
    lines = list(LINES)
    for index, key in changes:
        name = lines[index].split(":")[0].strip(" -")
        lines[index] = lines[index].replace(f"{name}:", f"{key}:", 1)
    outcome("".join(lines))


@given(st.integers(0, len(LOOP)), st.text(max_size=5), st.integers(0, 20))
def test_random_characters(position, inserted, removed):
    """Any characters typed anywhere over the file."""
    outcome(LOOP[:position] + inserted + LOOP[position + removed :])


TREES = st.recursive(
    st.sampled_from(ODD),
    lambda inner: (
        st.lists(inner, max_size=3) | st.dictionaries(st.sampled_from(KEYS), inner, max_size=4)
    ),
    max_leaves=12,
)


@given(st.dictionaries(st.sampled_from(list(entries(Scenario))), TREES, max_size=6))
def test_any_tree(tree):
    """Blocks, lists and texts where others belong."""

    def flow(node):
        if isinstance(node, dict):
            return "{" + ", ".join(f"'{key}': {flow(value)}" for key, value in node.items()) + "}"
        if isinstance(node, list):
            return "[" + ", ".join(map(flow, node)) + "]"
        return "'" + node.replace("'", "''").replace("\t", " ") + "'"

    outcome("\n".join(f"{key}: {flow(value)}" for key, value in tree.items()))


PATHS = [
    "duration", "load.force[0].value", "control.law", "set.cylinder.bore", "requirements.x.max",
    "supply.pump.slip", "x", "load.force", "control.speed[0].value", "set", "set.", "load[0]",
    "requirements.overshoot.max", "motor.machine.slip", "initial.position", "cylinder.bore",
]  # fmt: skip


@given(st.lists(st.tuples(st.sampled_from(PATHS), st.sampled_from(ODD)), max_size=3), st.booleans())
def test_odd_overrides(overrides, whole):
    """Any --set over a whole file, or over one that lacks what it names."""
    outcome(LOOP if whole else "load: 3\ncontrol: [x]\nset: y\n", overrides=overrides)


@pytest.fixture(scope="module")
def shelf(tmp_path_factory):
    """A folder with the servo knee in it, for many scenarios."""
    folder = tmp_path_factory.mktemp("shelf")
    (folder / "servo_knee.yaml").write_text(DESIGN, "utf-8")
    return folder


SET_PATHS = [
    "cylinder.bore", "cylinder.mount", "barrel.layup[1].angle", "barrel.layup[7].angle", "lines",
    "load_cases[0].position", "load_cases[stance].force", "requirements.mass.max", "valve.signal",
    "variables.rod.extension.lower", "objective.minimise", "retention.thread.pitch", "name", "x",
    "linkage.base_radius", "waivers.mass", "materials.nbr_90.density", "seals.rod.count", "a b", "",
]  # fmt: skip


@given(st.dictionaries(st.sampled_from(SET_PATHS), st.sampled_from(ODD), max_size=4))
def test_odd_changes_of_the_design(shelf, changes):
    """Any values under set: a design, or faults of either file, each with its place."""
    lines = "".join(f"  {json.dumps(path)}: {json.dumps(odd)}\n" for path, odd in changes.items())
    text = changed(SHORT, ("d.yaml", "servo_knee.yaml")) + ("set:\n" + lines if lines else "")
    (shelf / "run.yaml").write_text(text, "utf-8")
    found = []
    try:
        read_design_of(read_scenario(shelf / "run.yaml"))
    except InputError as error:
        found = error.diagnostics
    for fault in found:
        assert fault.file in (str(shelf / "run.yaml"), str(shelf / "servo_knee.yaml"))
        assert fault.line is not None
        assert fault.message


# --- the schema


@cache
def checker():
    """The schema as an editor applies it."""
    jsonschema = pytest.importorskip("jsonschema")
    schema = json_schema(Scenario, metrics=RESULTS)
    jsonschema.Draft7Validator.check_schema(schema)
    return jsonschema.Draft7Validator(schema)


def test_schema_takes_good_files():
    """What the reader takes shows no fault in an editor."""
    validator = checker()
    for text in (SHORT, *GOOD.values()):
        assert list(validator.iter_errors(yaml.safe_load(text))) == []
    more = "  name: x\n  materials.iso_vg_32.density: 870 kg/m^3\n  barrel.layup[1].angle: 80 deg\n"
    text = LOOP.replace("set:\n", REMOVED + "set:\n" + more)
    assert list(validator.iter_errors(yaml.safe_load(text))) == []


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("duration: 2 s", "duration: 2"),
        ("duration: 2 s", "duratoin: 2 s"),
        ("sample_time: 1 ms", "sample_time: 1 mm"),
        ("position: 30 %", "position: worst"),
        ("shape: ramp", "shape: rampe"),
        ("  law: pid", "  law: pdi"),
        ("  overshoot:", "  overshot:"),
        ("    max: 300 ms", "    max: 300 mm"),
        ("  cylinder.bore: 25 mm", "  cylinder.bor: 25 mm"),
        ("  cylinder.bore: 25 mm", "  cylinder.bore: 25 bar"),
        ("  gas_volume: 0.3 l", "  gas_volum: 0.3 l"),
        ("set:\n", "unset: [cushionn]\nset:\n"),
        ("set:\n", "unset: cushion\nset:\n"),
    ],
)
def test_schema_refuses_what_the_reader_refuses(folder, old, new):
    """Bad lines show in the editor too."""
    text = changed(LOOP, (old, new))
    assert list(checker().iter_errors(yaml.safe_load(text)))
    assert together(folder, text)


def walk(node):
    """Every object of a JSON value."""
    if isinstance(node, dict):
        yield node
    for value in node.values() if isinstance(node, dict) else node:
        if isinstance(value, (dict, list)):
            yield from walk(value)


def test_every_choice_says_what_each_word_means():
    """Whoever hovers over a choice reads what it decides, then the meaning of every word of it."""
    found = [node for node in walk(json_schema(Scenario, metrics=RESULTS)) if "enum" in node]
    assert len(found) > 20
    for node in found:
        if not all(isinstance(word, str) for word in node["enum"]):
            continue  # yes or no
        what, *said = re.split(rf"; ({'|'.join(node['enum'])}): ", node["description"])
        assert len(what.split()) >= 3
        assert said[::2] == node["enum"]


@pytest.mark.parametrize("quantity", SCENARIOS.values(), ids=list(SCENARIOS))
def test_quantities_take_their_units(quantity):
    """Editor and reader take each unit of a scenario's quantities, and no foreign one."""
    pattern = re.compile(quantity_schema(quantity)["pattern"])
    assert pattern.search(example(quantity))
    assert quantity.lower <= read_quantity(example(quantity), quantity) <= quantity.upper
    for name in units.units_of(quantity.dimension):
        assert pattern.search(f"1.5 {name}")
        assert units.parse(f"1.5 {name}", quantity.dimension) is not None
    for text in ("1.5 parsec", "nan", "one", "1,5 mm", "", "1..5"):
        assert not pattern.search(text)
        with pytest.raises((ValueFault, units.UnitError)):
            read_quantity(text, quantity)
    assert not set(SCENARIOS) & set(quantities.INPUTS)
