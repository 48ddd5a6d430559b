"""The worked design scripts: they run, and what they print is what they say."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import pytest
from script_loader import ran_here, script

from actuator_opt import api as verbs
from actuator_opt.evaluation.plugin import load

ROOT = Path(__file__).parents[2]
SCRIPTS = ROOT / "designs" / "scripts"


def test_every_script_of_the_folder_is_tested() -> None:
    """No shipped script is left out of this file."""
    assert {p.name for p in SCRIPTS.glob("*.py")} == {
        "aalto_rig.py",
        "aerospace_ends.py",
        "composite_saving.py",
        "course_servo.py",
        "custom_metric.py",
        "duty_pressure_levels.py",
        "knee_calibration.py",
        "knee_custom_constraint.py",
        "knee_dynamics.py",
        "knee_joints.py",
        "knee_pressure.py",
        "knee_seals.py",
        "knee_materials.py",
    }


@pytest.mark.parametrize(
    "name",
    ["composite_saving.py", "custom_metric.py", "knee_custom_constraint.py", "knee_pressure.py"],
)
def test_a_script_serves_as_a_plugin_file(name) -> None:
    """What a script declares can be evaluated with ``--plugin``, finite and with its own label."""
    plugins = load(SCRIPTS / name)
    evaluation = verbs.evaluate(ROOT / "designs" / "knee_bonded.yaml", plugins=plugins)
    for plugin in plugins:
        metric = evaluation.metrics[plugin.name]
        assert metric.value is not None
        assert metric.quantity.label == plugin.quantity.label


@pytest.fixture(scope="module")
def saving() -> Any:
    """The optima of the saving script, from one start."""
    return script("composite_saving").compute(starts=1)


def test_the_saving_script_prints_both_mass_tables(saving, capsys, monkeypatch) -> None:
    """Every part stands in one line with both masses, whose difference is the saving printed."""
    study = script("composite_saving")
    monkeypatch.setattr(study, "compute", lambda: saving)
    study.main()
    out = capsys.readouterr().out
    rows = dict(re.findall(r"^(\w[\w ]*?) {2,}([-\d. ]+)", out, re.MULTILINE))
    parts = ("barrel", "rod", "piston", "caps", "glands", "seals", "fastening", "clevises")
    sums = [0.0, 0.0]
    for part in parts:
        steel, composite, saved = (float(x) for x in rows[part].split()[:3])
        assert saved == pytest.approx(steel - composite, abs=0.011)
        sums[0] += steel
        sums[1] += composite
    steel, composite, _ = (float(x) for x in rows["dry mass"].split()[:3])
    assert sums == pytest.approx([steel, composite], abs=0.05)
    share = re.search(r"saving at equal requirements: ([\d.]+)%", out)
    assert share is not None
    assert float(share[1]) == pytest.approx(100 * (1 - composite / steel), abs=0.06)
    for published in ("30% to 70%", "up to 75%", "up to 80%"):
        assert published in out
    assert out.count("\n- ") == 7


def test_the_saving_is_computed_at_two_true_optima(saving, capsys) -> None:
    """Composite, steel and steel with aluminium ends are optima; who is lighter is said.

    What the carbon barrel saves over a steel one with screwed aluminium ends (about 42 g), its
    bonded caps take again.
    """
    study = script("composite_saving")
    for optimum in (saving.steel, saving.composite, saving.mixed):
        assert optimum.status == "optimal"
        assert optimum.kkt.residual <= 1e-6
    assert 0 < saving.share < 1
    study.print_reasons(saving)
    said = " ".join(capsys.readouterr().out.split())
    steel_ends = saving.steel.objective_value <= saving.mixed.objective_value
    assert ("a steel barrel save nothing:" in said) is steel_ends
    lighter = saving.composite.objective_value < saving.mixed.objective_value
    assert ("saves nothing more" in said) is not lighter
    assert ("saves another" in said) is lighter
    assert f"{1e3 * saving.mixed.objective_value:.1f} g" in said
    assert saving.thick.metrics["mass"].value > saving.steel.objective_value


def test_the_metric_script_prints_a_changed_optimum(tmp_path) -> None:
    """The added metric and constraint are both active and cost mass."""
    out = ran_here("custom_metric", tmp_path)
    assert list(tmp_path.iterdir()) == []
    masses = re.search(r"mass, g +([\d.]+) +([\d.]+)", out)
    assert masses is not None
    assert float(masses[2]) > float(masses[1])
    assert "active of the two: oil_per_cycle, guided_piston" in out


def test_the_added_metric_is_what_its_docstring_says() -> None:
    """Oil per cycle of a 23/13-110 cylinder is (A_A + A_B) s: 415.5 + 282.7 mm2 over 110 mm."""
    knee = verbs.read(
        ROOT / "designs" / "knee_bonded.yaml",
        set={"cylinder.bore": "23 mm", "rod.outer_diameter": "13 mm", "piston.length": "13.8 mm"},
        plugins=[SCRIPTS / "custom_metric.py"],
    )
    metrics = verbs.evaluate(knee).metrics
    assert metrics["oil_per_cycle"].value == pytest.approx((415.476 + 282.743) * 110e-9, rel=1e-5)
    assert metrics["guided_piston"].value == pytest.approx(13.8 / (0.7 * 23) - 1, abs=1e-9)
