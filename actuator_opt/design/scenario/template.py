"""The start file of `init --scenario`: a commented step under load for a design."""

from __future__ import annotations

from ..kinds import Text
from ..model import Design
from ..writer import scalar

STEP = 0.1
"""Step over the stroke (a choice: clearly visible, yet away from the stops)."""
LOAD = 0.3
"""Load over the smallest force of the load cases (a choice)."""
_HEAD = """\
# Events on a design over time. Every physical value has a unit.
#
#   actuator-opt check FILE                    all faults of this file and its design
#   actuator-opt simulate FILE --report        figures, results, balance of energy
#   actuator-opt simulate FILE --csv out.csv   every signal over time
name: @NAME@
design: @DESIGN@
# set:                         # changed values of the design, by PATH
#   load.mass: 30 kg

duration: 1 s
sample_time: 1 ms

initial:                       # at rest; default pressures hold the load
  position: 50 %               # of the stroke

load:
  force:                       # against extension; sum of parts: constant, step, ramp, pulse,
    - shape: constant          # sine, record (a column of a CSV file)
      value: @FORCE@
"""
_DRIVEN = """\

control:                       # or "signal:", which drives the valve with a voltage
  law: p                       # p, pi, pid; gain from the design, stated or tuned
  position:                    # relative to the initial position; or speed
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
    - shape: sine              # excitation
      value: @SWING@
      frequency: 20 Hz

# The design has no valve: its ports are closed, or at constant_pressure.
# If the design has a block "valve", a signal or a controller drives it here.
ends: closed

requirements:
  cavitation_margin:
    min: 1 bar
"""


def scenario_text(design: Design, path: str, name: str = "step under load") -> str:
    """A start file for a design.

    Parameters
    ----------
    design : design that gives stroke and load cases
    path : design file, as the scenario names it
    name : title of the scenario

    Raises
    ------
    ValueFault
        an invalid name
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
    """Two significant digits, without an exponent."""
    return f"{float(f'{value:.2g}'):.12g}"
