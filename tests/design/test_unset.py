"""Keys that the command line or a script removes, and choices that leave keys without meaning."""

from __future__ import annotations

import pytest
from cli_runner import DESIGNS, run
from typer.main import get_command

import actuator_opt as ao
from actuator_opt.base.errors import InputError
from actuator_opt.cli import app, completion

KNEE = DESIGNS / "knee.yaml"
SERVO = DESIGNS / "servo_knee.yaml"
BOND = ("--set", "retention.type=bond", "--set", "retention.material=epoxy_structural")
UNSET = ("--unset", "retention.thread", "--unset", "retention.sleeve", "--unset", "seals.static")
SHORT = f"""\
name: short
design: {SERVO}
duration: 20 ms
control:
  law: pid
  tuning: stated
  position_gain: 900 V/m
  integral_time: 1 s
  derivative_time: 1 ms
  filter_time: 2 ms
  position:
    - shape: step
      value: 1 mm
"""


def faults(*words):
    """The printed faults of `check` with further options."""
    lines = run("check", *map(str, words)).err.splitlines()
    return [line for line in lines if not line.startswith(" ") and "no faults" not in line]


def test_a_choice_names_the_keys_to_unset():
    """One line lists them with the options that remove them; with these, the file has no fault."""
    (line,) = faults(KNEE, *BOND)
    assert line.startswith("--set: retention.type: with bond, ")
    assert line.endswith(f"; add {' '.join(UNSET)}")
    assert run("check", str(KNEE), *BOND, *UNSET).code == 0


def test_only_the_choice_at_fault_is_named():
    """A choice that leaves nothing behind is not named; a missing key keeps its own line."""
    lines = faults(KNEE, *BOND[:2], "--set", "seals.rod.compound=nbr_70")
    assert len(lines) == 2
    assert lines[0].endswith(" ".join(UNSET))
    assert "retention.material: missing" in lines[1]


def test_a_removed_key_takes_its_default():
    """Without `back_up`, the seal is that of the word `none`, which itself removes nothing."""
    rings = [f"seals.piston.back_up_{name}" for name in ("material", "thickness")]
    removed = dict.fromkeys(rings)
    word = ao.read(KNEE, set=removed | {"seals.piston.back_up": "none"})
    none = ao.read(KNEE, set=removed | {"seals.piston.back_up": None})
    assert word.design == none.design
    assert word.design.seals.piston.back_up == "none"
    with pytest.raises(InputError, match=r"without it, .* add --unset seals.piston.back_up_mat"):
        ao.read(KNEE, set={"seals.piston.back_up": None})


def test_a_removed_block_takes_its_variables_along():
    """The entries of other tables for its values go too; others stay."""
    before = ao.read(KNEE).design
    assert any(path.startswith("retention.") for path in before.variables)
    after = ao.read(KNEE, set=dict(x.split("=") for x in BOND[1::2]) | dict.fromkeys(UNSET[1::2]))
    gone = ("retention.thread", "retention.sleeve", "seals.static")
    kept = {path for path in before.variables if not path.startswith(gone)}
    assert set(after.design.variables) == kept < set(before.variables)


@pytest.mark.parametrize(
    ("path", "message"),
    [
        ("cylinder.bore", "cannot be unset: it is required"),
        ("seals.piston.squeez", 'unknown PATH; did you mean "seals.piston.squeeze"'),
        ("cushion", "is not stated, so it cannot be unset"),
        ("seals.piston.width", "is not stated, so it cannot be unset"),
        ("barrel.layup[0]", "an entry of a list cannot be unset; change it in the file"),
        ("load_cases[nobody].force", "load_cases has no entry nobody"),
        ("a=b", "not a PATH"),
        ("", "not a PATH"),
    ],
)
def test_what_cannot_be_unset(path, message):
    """One line with place and remedy."""
    (line,) = faults(KNEE, "--unset", path)
    assert line.startswith("--unset: ")
    assert message in line


@pytest.mark.parametrize(
    "path", ["variables.cylinder.bore", "requirements", "load_cases[swing].speed", "notes"]
)
def test_what_can_be_unset(path):
    """Entries of tables, whole tables, keys in lists, texts."""
    known = path != "notes" or ao.read(KNEE).design.notes
    assert not known or faults(KNEE, "--unset", path) == []


def test_a_value_set_later_stays():
    """Keys are removed before any value is set, in whatever order the options come."""
    for changes in (
        {"requirements": None, "requirements.mass.max": "9 kg"},
        {"requirements.mass.max": "9 kg", "requirements": None},
    ):
        assert set(ao.read(KNEE, set=changes).design.requirements) == {"mass"}


def test_a_design_already_read():
    """`changed` removes keys in the same way."""
    changed = ao.read(KNEE).changed({"requirements.seal_gap.max": None})
    assert "seal_gap" not in changed.design.requirements
    values = {"requirements.mass.max": "9 kg", "requirements": None, "requirements.seal_gap": None}
    assert set(ao.read(KNEE).changed(values).design.requirements) == {"mass"}


def test_in_a_scenario(tmp_path):
    """A PATH of the scenario, or else of its design; a control law names the keys it leaves."""
    file = tmp_path / "short.yaml"
    file.write_text(SHORT, encoding="utf-8")
    (line,) = faults(file, "--set", "control.law=p")
    words = [
        *("--unset", "control.integral_time", "--unset", "control.derivative_time"),
        *("--unset", "control.filter_time"),
    ]
    assert line.startswith("--set: control.law: with p, ")
    assert set(words) <= set(line.split())
    assert run("simulate", str(file), "--set", "control.law=p", *words, "--quiet").code == 0
    trial = ao.read_scenario(file, set={"control.filter_time": None, "valve.offset": "1 mV"})
    assert trial.scenario.control.filter_time == pytest.approx(1e-3, rel=1e-12)
    (line,) = faults(file, "--unset", "valve.offset")
    assert "valve.offset: is not stated" in line


def test_every_command_with_set_has_unset():
    """And none that has not, such as `--vary` alone."""
    commands = get_command(app.app).commands if hasattr(app, "app") else app.command_line().commands
    options = {
        name: {word for option in one.params for word in option.opts}
        for name, one in commands.items()
    }
    assert {n for n, words in options.items() if "--set" in words} == {
        n for n, words in options.items() if "--unset" in words
    }


@pytest.mark.long
def test_runs_and_reports_repeat_it(tmp_path):
    """A recorded run keeps the removed keys; restoring it reads the same design."""
    place = {"ACTUATOR_OPT_RUNS": str(tmp_path)}
    words = ("--unset", "requirements.seal_gap", "--json", "--starts", "1")
    first = run("optimise", str(KNEE), *words, environment=place)
    assert first.code in (0, 1), first.err
    (record,) = tmp_path.iterdir()
    restored = ao.restore(ao.read_run(record))
    assert restored.run.body["input"]["unset"] == ["requirements.seal_gap"]
    assert "seal_gap" not in restored.actuator.design.requirements
    assert "requirements.seal_gap" in run("runs", "show", record.stem, environment=place).out


def test_completion(monkeypatch):
    """Every PATH that the file on the line states, and the blocks around it."""
    monkeypatch.setattr(completion, "typed", lambda: ("check", str(KNEE)))
    words = completion.unset("seals.piston.")
    assert "seals.piston.squeeze" in words
    assert "seals.piston.width" not in words
    assert {"retention.thread", "seals.static"} <= set(completion.unset(""))
    scenario = DESIGNS / "scenarios" / "course_position_servo.yaml"
    monkeypatch.setattr(completion, "typed", lambda: ("simulate", str(scenario)))
    assert {"friction", "friction.static"} <= set(completion.unset("friction"))
