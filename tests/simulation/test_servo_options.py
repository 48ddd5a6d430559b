"""Options of a servo: taper of the bristle damping, rest side of the spool, margins on demand."""

from __future__ import annotations

import json
import math
import re
import subprocess
import sys

import numpy as np
import pytest
from cli_runner import DESIGNS, run, surroundings

import actuator_opt as ao
from actuator_opt.simulation.assemble import assemble
from actuator_opt.simulation.linear import Linear, tune, ultimate
from actuator_opt.studies.plant import plant

SERVO = f"""\
name: servo
design: {DESIGNS / "servo_knee.yaml"}
duration: 0.3 s
load:
  force:
    - shape: constant
      value: 2 kN
friction:
  coulomb: 100 N
  bristle_travel: 20 um
  bristle_damping: 3000 N*s/m
control:
  position:
    - shape: step
      value: 20 mm
      start: 20 ms
"""


@pytest.fixture(scope="module")
def simulated():
    """The servo with changed values, simulated once each."""
    runs = {}

    def get(**changes):
        key = tuple(sorted(changes.items()))
        values = {path.replace("__", "."): value for path, value in key}
        if key not in runs:
            runs[key] = ao.simulate(SERVO, set=values)
        return runs[key]

    return get


def note(simulation, word):
    """The only note with a word; empty if there is none."""
    notes = [x for x in simulation.notes if word in x]
    assert len(notes) <= 1
    return notes[0] if notes else ""


def test_stated_damping_stays_as_stated(simulated):
    """By default only the computed damping falls with speed."""
    assert simulated().basis.to_dict().get("taper_speed") is None
    tapered = simulated(friction__bristle_damping=None)
    assert "taper_speed" in tapered.basis.to_dict()
    told = simulated(friction__bristle_taper="true").basis.to_dict()["taper_speed"]["value"]
    assert told == pytest.approx(0.5 * 4 * 100 * 3000 / 3000**2, rel=1e-9)  # half of 4 F_C/sigma_1


def test_friction_of_the_bristles_at_speed(simulated):
    """Force minus that of the deflection: sigma_1 dz/dt, times the taper where it is on."""
    for switch in ("true", "false"):
        one = simulated(friction__bristle_taper=switch)
        time, first = np.unique(one.time, return_index=True)
        z, v, force = (one.signals[n][first] for n in ("bristles", "speed", "friction"))
        rate = v - (100 / 20e-6) * np.abs(v) * z / 100  # z = F_C/sigma_0 in steady sliding
        taper = np.exp(-((v / (200 / 3000)) ** 2)) if switch == "true" else 1.0
        np.testing.assert_allclose(force - z * 100 / 20e-6, 3000 * taper * rate, atol=1e-6)
        assert np.max(np.abs(v)) > 0.1
        assert np.max(np.abs(rate)) > 1e-3
    assert time[0] == 0


def test_the_note_says_when_the_taper_acts(simulated):
    """Speed and share of the time above it; without taper, the speed that is no longer passive."""
    one = simulated(friction__bristle_taper="true")
    words = note(one, "bristle damping falls")
    limit, share = re.search(
        r"to 37 % at ([\d.]+) m/s, which .* exceeds ([\d.]+) %", words
    ).groups()
    assert float(limit) == pytest.approx(0.0667, rel=1e-3)
    moving = np.interp(grid := np.linspace(0, 0.3, 100001), one.time, np.abs(one.signals["speed"]))
    assert float(share) == pytest.approx(100 * np.mean(moving[grid >= 0] > 200 / 3000), rel=0.06)
    words = note(simulated(), "does not fall")
    assert "above 0.133 m/s" in words
    assert "friction.bristle_taper: true" in words
    slow = ao.simulate(SERVO, set={"control.position[0].value": "0.05 mm",
                                   "friction.bristle_taper": "true"})  # fmt: skip
    assert not note(slow, "bristle damping")


def test_the_switch_needs_bristles():
    """It is refused where no bristles are."""
    with pytest.raises(ao.InputError, match=r"bristle_taper: without effect"):
        ao.read_scenario(SERVO, set={"friction.model": "stribeck", "friction.bristle_damping": None,
                                     "friction.bristle_travel": None,
                                     "friction.bristle_taper": "true"})  # fmt: skip


def test_tuning_for_the_rest_side(simulated):
    """Half the ultimate gain of the loop with a spool that holds the load; a note has the other."""
    rest = simulated(control__tuning_side="rest").tuned
    worst = simulated(control__margin="2").tuned
    assert worst.gains.proportional_gain < rest.gains.proportional_gain
    trial = ao.read_scenario(SERVO)
    own = plant(trial.actuator.subject())
    linear = Linear.of(assemble(trial.scenario, own, {}, None, linear=True))
    gains = []
    for place in (0.5 * own.stroke, 0.5 * own.stroke + 0.02):
        loops = linear.about(position=place)
        # the load pushes the rod in, so oil must enter A: the spool rests on the extending side
        assert [loop is loops.loops[0] for loop in loops.rest] == [True]
        gains.append(ultimate(loops.rest[0]).gain)
    assert rest.gains.proportional_gain == pytest.approx(min(gains) / 2, rel=1e-9)
    assert rest.margins.gain == pytest.approx(2, rel=1e-6)
    told = float(re.search(r"the gain margin is ([\d.]+)", rest.notes[0])[1])
    other = 2 * worst.gains.proportional_gain / rest.gains.proportional_gain
    assert told == pytest.approx(other, rel=5e-3)
    assert not worst.notes


def test_without_load_both_sides_are_rest():
    """A balanced spool has no rest side, so both count."""
    trial = ao.read_scenario(SERVO, set={"load.force[0].value": "0 N"})
    own = plant(trial.actuator.subject())
    free = {"initial": trial.scenario.initial.model_copy(update={"pressure_a": None})}
    linear = Linear.of(assemble(trial.scenario.model_copy(update=free), own, {}, None, linear=True))
    found = linear.about()
    assert 1 <= len(found.rest) <= 2
    assert found.held


def test_margins_are_computed_where_needed(simulated):
    """The design's gain needs none, unless asked; a tuned gain has them."""
    one = simulated()
    assert one.tuned.origin == "control.gain of the design"
    assert one.tuned.margins is None
    told = one.to_dict()["controller"]
    assert told["gain_margin"] is None
    assert "--margins" in told["why"]
    asked = ao.simulate(SERVO, margins=True)
    assert asked.tuned.gains == one.tuned.gains
    assert asked.tuned.margins.gain == pytest.approx(
        asked.tuned.ultimate.gain / one.tuned.gains.proportional_gain, rel=1e-6
    )
    np.testing.assert_array_equal(asked.signals["position"], one.signals["position"])
    assert simulated(control__margin="3").tuned.margins.gain == pytest.approx(3, rel=1e-6)


def test_margins_at_the_terminal(tmp_path):
    """`--margins` prints them; a report asks for them too."""
    file = tmp_path / "servo.yaml"
    file.write_text(SERVO, encoding="utf-8")
    plain, asked = (run("simulate", str(file), *words, "--json") for words in ((), ("--margins",)))
    assert json.loads(plain.out)["controller"]["gain_margin"] is None
    assert json.loads(asked.out)["controller"]["gain_margin"] > 1
    trial = ao.read_scenario(file)
    shown = ao.write_simulation(ao.simulate(trial), trial, folder=tmp_path, format="html")
    text = shown[0].path.read_text(encoding="utf-8")
    assert "Controller and its margins" in text


def test_plants_are_kept_by_their_values():
    """The same design gives the same plant; a changed number a new one."""
    first = plant(ao.read_scenario(SERVO).actuator.subject())
    assert plant(ao.read_scenario(SERVO).actuator.subject()) is first
    changed = ao.read_scenario(SERVO, set={"load.mass": "21 kg"}).actuator.subject()
    assert plant(changed).mass == pytest.approx(first.mass + 21 - 20, rel=1e-12)
    assert math.isfinite(tune(ao.read_scenario(SERVO).scenario, first, {}).gains.proportional_gain)


THREADS = """
import numpy, actuator_opt as ao
from actuator_opt.base.arguments import guarded
from actuator_opt.base.threads import _library, libraries, one_thread
numpy.linalg.eigvals(numpy.eye(3))
own = _library("numpy")
if own is None:
    print("1 1 1"); raise SystemExit
own.set(2)
@guarded
def inside() -> int:
    with one_thread():
        pass
    return own.get()
print(own.get(), inside(), own.get())
"""


@pytest.mark.parametrize(
    ("stated", "counts"), [({}, "2 1 2"), ({"OPENBLAS_NUM_THREADS": "2"}, "2 2 2")]
)
def test_a_library_call_has_one_thread(stated, counts):
    """OpenBLAS has one thread inside a call and the former number after it, unless stated."""
    names = ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS", "GOTO_NUM_THREADS")
    environment = {k: v for k, v in surroundings().items() if k not in names}
    done = subprocess.run(
        [sys.executable, "-c", THREADS], capture_output=True, text=True, env=environment | stated
    )
    assert done.stdout.strip() in (counts, "1 1 1"), done.stderr
