"""Designs with duty cycles through commands: their files stay with runs, reports and stores."""

from __future__ import annotations

import re
import shutil
from pathlib import Path

import pytest
import yaml
from cli_runner import BENCH, run

import actuator_opt as ao
from actuator_opt.api import starting
from actuator_opt.base.errors import InputError, UsageError
from actuator_opt.design.cycle_peaks import peaks
from actuator_opt.evaluation.build import spec_hash

CYCLES = Path("designs/cycles")
BLOCK = """duty:
  cycles:
    - {name: walk, file: gait_knee.csv, lever_arm: 50 mm}
    - {name: run, file: run_knee.csv, lever_arm: 50 mm}

variables:
"""
SMALL = BENCH.replace("  retention.wall:\n    lower: 1 mm\n    upper: 10 mm\n", "")


@pytest.fixture
def design(tmp_path):
    """A small design with two cycles, in a folder of its own."""
    folder = tmp_path / "design"
    folder.mkdir()
    for name in ("gait_knee.csv", "run_knee.csv"):
        shutil.copy(CYCLES / name, folder)
    path = folder / "small.yaml"
    path.write_text(SMALL.replace("variables:\n", BLOCK, 1))
    return path


def digests(actuator):
    """Digests of all cycles of a design."""
    return [cycle.record.digest for cycle in actuator.design.duty.cycles]


@pytest.mark.long
def test_a_run_and_its_report_contain_the_cycles(design, tmp_path):
    """With all files gone, the run is restored and the report repeated, with the same hash."""
    actuator = ao.read(design)
    result = ao.optimise(actuator, starts=1, prices=False)
    recorded = ao.record(result, actuator=actuator, folder=tmp_path / "runs")
    command = f"actuator-opt evaluate {design}"
    files = ao.report(ao.evaluate(actuator), actuator=actuator, folder=tmp_path, command=command)
    shutil.rmtree(design.parent)
    restored = ao.restore(recorded)
    assert restored.doubts == ()
    assert digests(restored.actuator) == digests(actuator)
    best = ao.Actuator(restored.result.best)
    assert digests(best) == digests(actuator)
    assert restored.result.best == result.best
    again = ao.rerun(next(file.path for file in files if file.path.suffix == ".pdf"))
    assert again.repeats
    assert digests(again.actuator) == digests(actuator)


def test_a_store_contains_the_cycles(design, tmp_path, monkeypatch):
    """Its design can be read with all files gone, and other files are other studies."""
    store = tmp_path / "rows.db"
    vary = ("--vary", "load.mass=10 kg,20 kg", "--store", store, "--json")
    assert run("sweep", design, *vary).json["computed"] == 2
    assert run("sweep", design, *vary).json["reused"] == 2
    other = design.with_name("gait_knee.csv")
    text = other.read_text()
    other.write_text(text.replace("-20.3903", "-20.3904"))
    assert run("sweep", design, *vary).json["computed"] == 2
    shutil.rmtree(design.parent)
    explored = run("explore", store, "--out", tmp_path / "explored.html")
    assert explored.code == 0, explored.err


def test_the_file_of_a_cycle_cannot_be_varied(design):
    """A store knows the files of the design only."""
    result = run("sweep", design, "--vary", "duty.cycles[walk].file=gait_knee.csv,run_knee.csv")
    assert result.code == 3
    assert "the name of a file cannot be varied" in result.err


@pytest.mark.long
def test_a_written_optimum_names_its_files_from_its_own_folder(design, tmp_path):
    """`--write` into another folder; the hash of the stamp is that of the file."""
    target = tmp_path / "best.yaml"
    result = run("optimise", design, "--starts", 1, "--write", target, "--quiet")
    assert result.code == 0, result.err
    text = target.read_text()
    assert "design/gait_knee.csv" in text
    stamp = re.search(r"spec hash is (\w+)", text)
    assert stamp[1] == spec_hash(ao.read(target).subject())


@pytest.fixture
def _one_search(monkeypatch):
    """The first sizes alone lead to a design."""
    monkeypatch.setattr(starting, "STARTS", 1)


@pytest.mark.usefixtures("_one_search")
def test_init_writes_a_design_for_a_joint(tmp_path, monkeypatch):
    """Its load cases carry the peaks of the cycle, which it names; `check` finds no fault."""
    monkeypatch.chdir(tmp_path)
    cycles = tmp_path / "cycles"
    cycles.mkdir()
    shutil.copy(Path(__file__).parents[2] / CYCLES / "gait_knee.csv", cycles)
    file = cycles / "gait_knee.csv"
    made = run("init", "leg", "--cycle", "cycles/gait_knee.csv", "--lever-arm", "50 mm", "--yes")
    assert made.code == 0, made.err
    data = yaml.safe_load((tmp_path / "leg.yaml").read_text())
    assert data["duty"]["cycles"] == [
        {"name": "gait_knee", "file": "cycles/gait_knee.csv", "lever_arm": "50 mm"}
    ]
    design = ao.read("leg.yaml").design
    most = peaks(design.duty.cycles[0])
    push, pull = (case.joint_torque / case.lever_arm for case in design.load_cases)
    assert most.push <= push <= 1.01 * most.push
    assert most.pull <= pull <= 1.01 * most.pull
    assert most.speed <= design.load_cases[0].speed <= 1.01 * most.speed
    assert most.travel <= design.cylinder.stroke <= most.travel + 1e-3
    assert run("check", "leg.yaml").code == 0
    assert file.exists()


@pytest.mark.usefixtures("_one_search")
def test_init_writes_a_design_for_a_rod(tmp_path):
    """In another folder; stated options have precedence over the cycle."""
    target = tmp_path / "wing.yaml"
    made = run(
        "init", "wing", "--cycle", CYCLES / "flight_control_synthetic.csv", "--pressure", "210 bar",
        "--push", "20 kN", "--yes", "--out", target,
    )  # fmt: skip
    assert made.code == 0, made.err
    assert "coarse sampling" in made.err
    design = ao.read(target).design
    cycle = design.duty.cycles[0]
    most = peaks(cycle)
    assert cycle.file.endswith("designs/cycles/flight_control_synthetic.csv")
    assert cycle.lever_arm is None
    assert design.load_cases[0].force == 20e3
    assert most.pull <= design.load_cases[1].force <= 1.01 * most.pull
    assert most.position_high <= design.cylinder.stroke <= most.position_high + 1e-3


def test_init_refuses_a_cycle_that_it_cannot_use(tmp_path):
    """A joint without a lever arm, positions below zero, a faulty file, a second source."""
    from actuator_opt.api.starting_cycle import cycle_start

    with pytest.raises(UsageError, match="states the motion of a joint"):
        cycle_start(CYCLES / "gait_knee.csv")
    low = tmp_path / "low.csv"
    low.write_text("time [s],position [mm],force [N]\n0,-5,1\n1,6,1\n2,7,1\n3,-5,1\n")
    with pytest.raises(UsageError, match="positions begin at -5 mm"):
        cycle_start(low)
    low.write_text("time [s],position [mm],force [N]\n0,5,1\n1,6,1\n")
    with pytest.raises(InputError, match="2 samples"):
        cycle_start(low)
    for other in (("--scenario", "designs/knee.yaml"), ("--from", "x.yaml", "--push", "5 kN")):
        result = run("init", "--cycle", low, *other)
        assert result.code == 2
        assert "use only one of them" in result.err


def test_init_adds_a_cycle_to_a_copy_of_a_design_with_a_linkage(tmp_path):
    """The linkage gives position and lever arm; a second cycle follows the first."""
    first, second = tmp_path / "a.yaml", tmp_path / "b.yaml"
    source = tmp_path / "knee.yaml"
    knee = Path("designs/knee.yaml").read_text(encoding="utf-8")
    source.write_text(
        f"{knee}linkage: {{base_radius: 240 mm, crank_radius: 62 mm, angle_offset: 120 deg}}\n"
    )
    made = run("init", "--from", source, "--cycle", CYCLES / "gait_knee.csv", "--out", first)
    assert made.code == 0, made.err
    design = ao.read(first).design
    (cycle,) = design.duty.cycles
    assert (cycle.name, cycle.lever_arm) == ("gait_knee", None)
    assert design.linkage.crank_radius == pytest.approx(0.062)
    assert len(design.variables) == len(ao.read("designs/knee.yaml").design.variables)
    made = run("init", "--from", first, "--cycle", CYCLES / "run_knee.csv", "--out", second)
    assert "single samples far off" in made.err
    assert [x.name for x in ao.read(second).design.duty.cycles] == ["gait_knee", "run_knee"]
    again = run("init", "--from", second, "--cycle", CYCLES / "run_knee.csv", "--out", "-")
    assert again.code == 2
    assert "has a cycle or load case 'run_knee' already; rename the CSV file" in again.err


def test_init_says_what_a_joined_cycle_lacks(tmp_path):
    """The file is written; a rod that must go too far names the stroke that is enough."""
    far = tmp_path / "far.csv"
    far.write_text("time [s],position [mm],force [N]\n0,5,1\n1,60,1\n2,125,1\n3,60,1\n4,5,1\n")
    target = tmp_path / "far.yaml"
    made = run("init", "--from", "designs/knee.yaml", "--cycle", far, "--out", target)
    assert made.code == 1
    assert "the cycle does not fit yet" in made.err
    assert "too little travel: the piston would be 15 mm beyond the extended stop" in made.err
    assert ao.read(target).design.duty.cycles[0].name == "far"


def test_init_needs_a_linkage_or_a_lever_arm_for_a_joint():
    """The knee alone has neither; the lever arm may be stated beside the copied design."""
    known = "init", "--from", "designs/knee.yaml", "--cycle", CYCLES / "gait_knee.csv", "--out", "-"
    made = run(*known)
    assert made.code == 2
    assert "or --from a design with a linkage" in made.err
    made = run(*known, "--lever-arm", "50 mm")
    assert made.code == 0
    assert yaml.safe_load(made.out)["duty"]["cycles"][0]["lever_arm"] == "50 mm"
