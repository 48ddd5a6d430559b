"""The start file of `init --scenario`: a step under load around a design, commented."""

from __future__ import annotations

from ..kinds import Text
from ..model import Design
from ..writer import scalar

STEP = 0.1
"""Step over the stroke (a choice: large enough to see, small enough to stay off the stops)."""
LOAD = 0.3
"""Load over the least force that a load case asks (a choice)."""
_HEAD = """\
# What happens to a design over time. Every physical value carries its unit.
#
#   actuator-opt check FILE                    all faults of this file and its design
#   actuator-opt simulate FILE --report        figures, results, balance of energy
#   actuator-opt simulate FILE --csv out.csv   every signal over time
name: @NAME@
design: @DESIGN@
# set:                         # values of the design that are other here, by PATH
#   load.mass: 30 kg

duration: 1 s
sample_time: 1 ms

initial:                       # at rest; the pressures hold the load unless stated
  position: 50 %               # of the stroke

load:
  force:                       # against extension; parts add up: constant, step, ramp, pulse,
    - shape: constant          # sine, record (a column of a CSV file)
      value: @FORCE@
"""
_DRIVEN = """\

control:                       # in its place, "signal:" drives the valve with volts
  law: p                       # p, pi, pid; a gain is the design's, stated here, or tuned
  position:                    # counted from the start; or speed
    - shape: step
      value: @STEP@
      start: 0.1 s

requirements:                  # also settling_time, hold_drift, cavitation_margin, ...
  rise_time:
    max: 0.3 s
  overshoot:
    max: 10 %
  steady_state_ratio:
    max: 2 %
"""
_SHAKEN = """\
    - shape: sine              # what shakes it
      value: @SWING@
      frequency: 20 Hz

# The design has no valve: its ports stay closed, or at constant_pressure.
# With a block "valve" in the design a signal or a controller drives it here.
ends: closed

requirements:
  cavitation_margin:
    min: 1 bar
"""


def scenario_text(design: Design, path: str, name: str = "step under load") -> str:
    """A start file around a design.

    Parameters
    ----------
    design : whose stroke and load cases it takes
    path : of its file, as the scenario names it
    name : title of the scenario

    Raises
    ------
    ValueFault
        a name that cannot stand in a file
    """
    title = Text().validate(name)
    asked = [abs(case.force) for case in design.load_cases if case.force]
    force = LOAD * min(asked, default=0.0)
    text = _HEAD + (_SHAKEN if design.valve is None else _DRIVEN)
    for mark, said in (
        ("@NAME@", scalar(title)),
        ("@DESIGN@", scalar(path)),
        ("@FORCE@", f"{_round(force)} N"),
        ("@SWING@", f"{_round(0.5 * force)} N"),
        ("@STEP@", f"{_round(STEP * design.cylinder.stroke * 1e3)} mm"),
    ):
        text = text.replace(mark, said)
    return text


def _round(value: float) -> str:
    """Two digits, without a power of ten."""
    return f"{float(f'{value:.2g}'):.12g}"
