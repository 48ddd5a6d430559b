"""The block `duty`: cycles in a design, their PATHs and faults, and their files."""

from __future__ import annotations

import copy
import json
import math
import pickle
import re
import shutil
from pathlib import Path

import jsonschema
import numpy as np
import pytest
import yaml

import actuator_opt as ao
from actuator_opt.api.checking import examine
from actuator_opt.base.errors import InputError
from actuator_opt.design import numbers, with_values
from actuator_opt.design.cycle_peaks import peaks, rod_course
from actuator_opt.design.data_file import DataFile, moved, portable, texts_of
from actuator_opt.design.duty import DutyCycle, cycle_of
from actuator_opt.design.paths import canonical, words_of
from actuator_opt.design.reader import read_design
from actuator_opt.design.schema import json_schema
from actuator_opt.design.writer import to_yaml
from actuator_opt.evaluation import prepare
from actuator_opt.evaluation.build import spec_hash

KNEE = Path("designs/knee.yaml").read_text("utf-8")
CYCLES = Path("designs/cycles")
LINKAGE = """linkage:
  base_radius: 240 mm
  crank_radius: 62 mm
  angle_offset: 120 deg
"""
BLOCK = """duty:
  cycles:
    - name: walk
      file: gait_knee.csv         # of a person of 60 kg
      repeats: 5e6
      torque_scale: 1.2
      starts: 2000
    - name: run
      file: run_knee.csv
      supply_pressure: 140 bar
      also: [{phase: 50 %}]
  opening_limit: 80 %
  standby: 2000 h
  tank: {cooler_conductance: 30 W/K}
  wear:
    piston: {rate: 2e-17 m^2/N, depth: 0.1 mm}
  supply:
    pump_efficiency: 85 %
    mission_time: 2 h
    specific_energy: 0.6 MJ/kg
    pump_mass: 1 kg/kW
    cooler_mass: 30 g*K/W
    accumulator_mass: 1.5 kg/l
"""
AXIAL = "time [s],position [mm],force [N]\n0,20,500\n.3,60,800\n.5,90,-200\n.8,50,-600\n1,20,500\n"


def write(folder, block=BLOCK, linkage=LINKAGE, name="knee.yaml"):
    """The robot knee with a linkage and this block, beside the shipped cycles."""
    for file in CYCLES.glob("*.csv"):
        shutil.copy(file, folder)
    (folder / "axial.csv").write_text(AXIAL)
    path = folder / name
    path.write_text(KNEE.replace("variables:\n", f"{linkage}\n{block}\nvariables:\n", 1), "utf-8")
    return path


@pytest.fixture(scope="module")
def place(tmp_path_factory):
    """A folder with the design `knee.yaml` and its cycles."""
    folder = tmp_path_factory.mktemp("duty")
    write(folder)
    return folder


@pytest.fixture(scope="module")
def knee(place):
    """The design with two cycles."""
    return read_design(place / "knee.yaml").design


def faults(path, *overrides):
    """The faults of a design file, each in one line."""
    with pytest.raises(InputError) as error:
        read_design(path, overrides=overrides)
    lines = [str(fault) for fault in error.value.diagnostics]
    assert all(fault.remedy for fault in error.value.diagnostics)
    return "\n".join(lines)


def test_the_block_is_read_in_si(knee):
    """Every unit once; defaults are those of the block's table."""
    duty = knee.duty
    walk, run = duty.cycles
    assert (walk.repeats, walk.torque_scale, walk.starts) == (5e6, 1.2, 2000)
    assert (walk.closed, walk.phase, walk.supply_pressure) == (True, 0.0, None)
    assert (run.repeats, run.supply_pressure, run.also[0].phase) == (None, 140e5, 0.5)
    assert (duty.opening_limit, duty.standby, duty.thermal) == (0.8, 2000 * 3600.0, "worst")
    assert duty.tank.cooler_conductance == 30
    assert (duty.oil_supply, duty.ambient, duty.emissivity) == (None, 293.15, 0.9)
    assert (duty.wear.piston.rate, duty.wear.piston.depth) == (2e-17, 1e-4)
    supply = duty.supply
    assert (supply.pump_efficiency, supply.mission_time, supply.specific_energy) == (
        0.85, 7200.0, 6e5,
    )  # fmt: skip
    assert (supply.pump_mass, supply.cooler_mass) == (1e-3, 0.03)
    assert supply.accumulator_mass == 1500.0
    stated = {"pump_efficiency", "mission_time", "specific_energy", "pump_mass", "cooler_mass",
              "accumulator_mass"}  # fmt: skip
    unset = {name for name in type(supply).model_fields if getattr(supply, name) is None}
    assert unset == set(type(supply).model_fields) - stated  # no mass is assumed


def test_the_record_comes_with_the_design(knee, place):
    """Relative to the folder of the design, unscaled."""
    record = knee.duty.cycles[0].record
    assert record.name == str(place / "gait_knee.csv")
    assert record.torque.max() == pytest.approx(27.5874)  # of the file
    finer = knee.duty.model_copy(update={"samples": 301.0}).record(knee.duty.cycles[0])
    assert finer.time.size == 301
    assert knee.duty.record(knee.duty.cycles[0]) is record


def test_every_number_is_a_path(knee):
    """By the name of the cycle; all numbers of the block are values of the models."""
    assert canonical("duty.cycles[0].torque_scale", knee) == "duty.cycles[walk].torque_scale"
    values = numbers(knee)
    assert values["duty.cycles[walk].torque_scale"] == 1.2
    assert values["duty.cycles[run].also[0].phase"] == 0.5
    assert values["duty.supply.mission_time"] == 7200.0
    assert words_of("duty.cycles[walk].torque_scale") == "torque scale walk"
    changed = with_values(knee, {"duty.cycles[walk].torque_scale": 2.0, "duty.standby": "1 h"})
    assert (changed.duty.cycles[0].torque_scale, changed.duty.standby) == (2.0, 3600.0)
    assert changed.duty.cycles[0].record is knee.duty.cycles[0].record


def test_a_number_of_a_cycle_can_be_a_variable_or_uncertain(tmp_path):
    """With bounds and scatter in the units of the PATH."""
    text = write(tmp_path).read_text("utf-8")
    entry = "  duty.cycles[walk].torque_scale:\n    lower: 1\n    upper: 1.4\n"
    text = text.replace("variables:\n", f"variables:\n{entry}", 1)
    text += "uncertainty:\n  duty.cycles[walk].time_scale: {distribution: normal, cv: 5 %}\n"
    (tmp_path / "v.yaml").write_text(text, "utf-8")
    design = read_design(tmp_path / "v.yaml").design
    assert design.variables["duty.cycles[walk].torque_scale"].upper == 1.4
    assert design.uncertainty["duty.cycles[walk].time_scale"].cv == 0.05


def test_closed_decides_the_spline(knee):
    """The same file as an open course has other slopes at its ends."""
    opened = with_values(knee, {"duty.cycles[walk].closed": "false"}).duty.cycles[0].record
    closed = knee.duty.cycles[0].record
    assert (opened.closed, closed.closed) == (False, True)
    assert opened.digest == closed.digest
    assert opened.speed[0] != closed.speed[0]
    assert opened.speed[50] == pytest.approx(closed.speed[50], rel=1e-9)


def test_another_file_is_read_from_the_folder_of_the_design(knee, place):
    """By a script as by the command line."""
    changed = with_values(knee, {"duty.cycles[walk].file": "run_knee.csv"})
    assert changed.duty.cycles[0].record.digest == knee.duty.cycles[1].record.digest
    override = [("duty.cycles[walk].file", "run_knee.csv")]
    again = read_design(place / "knee.yaml", overrides=override).design
    assert again.duty == changed.duty
    with pytest.raises(InputError, match=r"duty.cycles\[walk\].file: .*nix.csv: no such file"):
        with_values(knee, {"duty.cycles[walk].file": "nix.csv"})


def test_the_hash_counts_the_content_of_files(tmp_path, knee):
    """Not their names; and no hash of a design without cycles changes."""
    first = spec_hash(prepare(knee))
    path = write(tmp_path, BLOCK.replace("gait_knee.csv", "other.csv"))
    text = (tmp_path / "gait_knee.csv").read_text()
    (tmp_path / "other.csv").write_text(f"# a comment\n{text}")
    assert spec_hash(prepare(read_design(path).design)) == first
    (tmp_path / "other.csv").write_text(text.replace("-20.3903", "-20.3904"))
    assert spec_hash(prepare(read_design(path).design)) != first
    plain = read_design(Path("designs/knee.yaml")).design
    assert "duty" not in str(plain.model_dump(exclude_none=True).keys())


def test_copies_keep_the_content(knee):
    """Pickled for another process, and copied."""
    for other in (pickle.loads(pickle.dumps(knee)), copy.deepcopy(knee)):
        assert other == knee
        assert other.duty.cycles[0].record.digest == knee.duty.cycles[0].record.digest
    renamed = DataFile("gait_knee.csv", AXIAL)
    assert renamed != knee.duty.cycles[0].file
    assert renamed == "gait_knee.csv"


def test_the_writer_repeats_the_block(tmp_path, knee, place):
    """Comments stay, new values are put in place, and the text reads back as the same design."""
    loaded = read_design(place / "knee.yaml")
    changed = with_values(loaded.design, {"duty.cycles[walk].torque_scale": 1.5})
    text = to_yaml(changed, loaded.source)
    assert "# of a person of 60 kg" in text
    assert "torque_scale: 1.5" in text
    for content in (text, to_yaml(changed)):
        (place / "again.yaml").write_text(content, "utf-8")
        assert read_design(place / "again.yaml").design == changed


def test_a_design_in_another_folder_names_the_same_files(tmp_path, place):
    """`save` into a folder below, and beside."""
    design = ao.read(place / "knee.yaml")
    below = place / "below"
    below.mkdir()
    for folder, name in ((below, "../gait_knee.csv"), (place, "gait_knee.csv")):
        path = ao.save(design, folder / "new.yaml")
        assert re.search(rf"file: '?{re.escape(name)}'?", path.read_text("utf-8"))
        assert spec_hash(ao.read(path).subject()) == spec_hash(design.subject())


def test_a_portable_design_needs_no_files(tmp_path, knee):
    """Its text contains the cycles, with the names of their files."""
    text = to_yaml(portable(knee))
    design = read_design(text).design
    walk = design.duty.cycles[0]
    assert (walk.file.inside, walk.file.label) == (True, "gait_knee.csv")
    assert texts_of(design) == {}
    assert spec_hash(prepare(design)) == spec_hash(prepare(knee))
    assert to_yaml(portable(design)) == text
    assert moved(design, tmp_path) == design


def test_texts_of_files_replace_files(knee):
    """As for a recorded run, whose files are gone."""
    files = texts_of(knee)
    assert sorted(files) == ["gait_knee.csv", "run_knee.csv"]
    design = read_design(to_yaml(knee), files=files).design
    assert spec_hash(prepare(design)) == spec_hash(prepare(knee))


def test_a_design_that_was_not_read_has_no_record(knee):
    """One clear line instead of a wrong result."""
    cycle = knee.duty.cycles[0].model_copy(update={"file": "gait_knee.csv"})
    with pytest.raises(InputError, match="cycle walk: its file was not read"):
        _ = cycle.record


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (("torque_scale: 1.2", "torque_scale: 0"), "torque_scale: 0: must be > 0"),
        (("repeats: 5e6", "repeats: -1"), "repeats: -1: must be >= 0"),
        (("name: run", "name: walk"), '"walk": also the name of entry 0'),
        (("name: run", "name: stance"), '"stance": also the name of a load case'),
        (("140 bar", "5 bar"), "5 bar: not above supply.return_pressure (5 bar)"),
        (("140 bar", "240 bar"), "240 bar: above supply.pressure (210 bar)"),
        (("tank:", "oil_supply: 40 degC\n  tank:"), "both oil_supply and tank"),
        (("pump_efficiency: 85 %", "pressure_drop: 205 bar"), "not less than supply minus return"),
        (("pump_efficiency: 85 %", "pump_efficiency: 120 %"), "120 %: outside the valid range"),
        (("starts: 2000", "force_scale: 2"), "force_scale: without effect with the columns joint"),
        (("starts: 2000", "closed: false\n      phase: 10 %"), "phase: without effect with closed"),
        (("starts: 2000", "start: 2000"), 'unknown key; did you mean "starts"?'),
        (("run_knee.csv", "axial.csv\n      lever_arm: 40 mm"), "lever_arm: without effect"),
        (("run_knee.csv", "axial.csv\n      torque_scale: 2"), "torque_scale: without effect"),
        (("run_knee.csv", "'-'"), '"-" is not a file'),
        (("run_knee.csv", "nix.csv"), "nix.csv: no such file"),
        (("run_knee.csv", "run_knee"), "did you mean"),
        (("run_knee.csv", "."), "is a folder"),
        (("mission_time: 2 h", "mission_time: 2 bar"), "bar is a pressure, need a time"),
        (("0.6 MJ/kg", "0.6 MJ"), 'unknown unit "MJ"; use one of MJ/kg'),
        (("2e-17 m^2/N", "2e-17"), "unit missing"),
    ],
    ids=lambda value: value[1] if isinstance(value, tuple) else "",
)
def test_a_faulty_block_is_refused_with_its_line(tmp_path, change, message):
    """At the line of the design file."""
    text = faults(write(tmp_path, BLOCK.replace(*change, 1)))
    assert message in text
    assert re.match(r".*knee\.yaml:\d+:\d+: duty", text)


def test_faults_at_lines_of_a_cycle_come_with_those_of_the_design(tmp_path):
    """Both files at once, the cycle's first; `check` lists the same."""
    path = write(tmp_path, BLOCK.replace("repeats: 5e6", "repeats: -1"))
    cycle = tmp_path / "run_knee.csv"
    rows = cycle.read_text().splitlines()
    rows[20] = "0.0905,fast,1"
    cycle.write_text("\n".join(rows))
    lines = faults(path).splitlines()
    assert lines[0].startswith(f'{cycle}:21: "fast" in column "joint_angle" is not a number')
    assert "knee.yaml:140:16: duty.cycles[walk].repeats: -1" in lines[1]
    assert "\n".join(map(str, ao.check(path))).splitlines() == lines


def test_a_joint_needs_a_linkage_or_a_lever_arm(tmp_path):
    """A constant lever arm is enough; a linkage must not pass a dead point."""
    assert "there is no linkage" in faults(write(tmp_path, linkage=""))
    arm = BLOCK.replace("_knee.csv", "_knee.csv\n      lever_arm: 50 mm")
    design = read_design(write(tmp_path, arm, linkage="")).design
    assert design.duty.cycles[0].lever_arm == 0.05
    dead = faults(write(tmp_path), ("linkage.angle_offset", "60 deg"))
    assert "gait_knee.csv, line" in dead or "run_knee.csv, line" in dead
    assert "dead point" in dead


def test_a_column_of_supply_pressure_is_checked(tmp_path):
    """Against return and supply pressure, and against a level of the cycle."""
    rows = AXIAL.splitlines()
    block = BLOCK.replace("gait_knee.csv", "axial.csv").replace("torque_scale: 1.2\n", "\n")
    for pressure, message in (("4", "4 bar: not above supply.return_pressure (5 bar)"),
                              ("211", "211 bar: above supply.pressure (210 bar)")):  # fmt: skip
        path = write(tmp_path, block)
        lines = [f"{row},{pressure}" for row in rows[1:]]
        (tmp_path / "axial.csv").write_text("\n".join([f"{rows[0]},supply_pressure [bar]", *lines]))
        assert f"column supply_pressure, {message}" in faults(path)
    stated = write(tmp_path, block.replace("starts: 2000", "supply_pressure: 100 bar"))
    lines = [f"{row},100" for row in rows[1:]]
    (tmp_path / "axial.csv").write_text("\n".join([f"{rows[0]},supply_pressure [bar]", *lines]))
    assert "the file has a column supply_pressure too" in faults(stated)


def test_check_warns_of_doubtful_data(place):
    """The torque of the run around foot strike; no warning stops a design."""
    examined = examine(place / "knee.yaml")
    assert examined.faults == []
    assert any(text.startswith("duty.cycles[run]: joint_torque") for text in examined.warnings)


def test_a_choice_of_files_is_refused(tmp_path):
    """A cycle's file is not a choice: state two cycles."""
    text = write(tmp_path).read_text("utf-8")
    text += "choices:\n  duty.cycles[walk].file: [gait_knee.csv, run_knee.csv]\n"
    (tmp_path / "c.yaml").write_text(text, "utf-8")
    assert "free text" in faults(tmp_path / "c.yaml")


def test_ideal_cylinders_have_no_cycles():
    """The block means nothing beside a cylinder stated by its numbers."""
    text = """name: ideal
fluid: {material: iso_vg_32}
supply: {pressure: 100 bar}
ideal: {area_a: 5 cm^2, area_b: 3 cm^2, stroke: 100 mm, mass: 2 kg}
duty: {cycles: [{name: walk, file: x.csv}]}
"""
    assert "duty: has no effect: ideal states the cylinder" in faults(text)


def test_the_schema_accepts_the_block(place):
    """As an editor checks it, with PATHs of cycles among the variables."""
    data = yaml.safe_load((place / "knee.yaml").read_text("utf-8"))
    data["variables"] |= {
        "duty.cycles[walk].torque_scale": {"lower": 1, "upper": 2},
        "duty.cycles[run].also[0].phase": {"lower": "0 %", "upper": "60 %"},
    }
    validator = jsonschema.Draft7Validator(json_schema())
    assert not list(validator.iter_errors(json.loads(json.dumps(data))))
    data["duty"]["cycles"][0]["torque_scale"] = "2 mm"
    assert not validator.is_valid(data)


# --- what a cycle asks at most ---------------------------------------------------------------


def test_peaks_of_the_gait_through_a_linkage(knee):
    """Forces, speed and travel that an independent program gives for the whole file."""
    geometry = knee.linkage.model_copy(update={"base_radius": 0.25})
    cycle = knee.duty.cycles[0].model_copy(update={"torque_scale": 1.0})
    most = peaks(cycle, geometry)
    assert most.push == pytest.approx(512.698, rel=2e-6)
    assert most.pull == pytest.approx(532.963, rel=2e-6)
    assert most.speed == pytest.approx(0.380186, rel=2e-6)
    assert most.travel == pytest.approx(0.094067 - 0.0325207, rel=2e-6)
    course = rod_course(cycle, geometry)
    assert np.abs(np.diff(course.travel)).sum() == pytest.approx(0.141225, rel=4e-6)
    work = np.diff(course.travel) * (course.force[1:] + course.force[:-1]) / 2
    assert work[work > 0].sum() == pytest.approx(4.75351, rel=2e-6)
    assert -work[work < 0].sum() == pytest.approx(13.8445, rel=4e-6)
    assert (most.reversals, most.position_low, most.period) == (4, None, 1.1)
    assert most.torque == pytest.approx(27.5874)


def test_scales_and_a_constant_lever_arm():
    """F = k T/a, x = a theta, v = a w/m; power k/m."""
    text = (CYCLES / "gait_knee.csv").read_text("utf-8")
    file = DataFile("gait.csv", text)
    one = peaks(DutyCycle(name="walk", file=file, lever_arm=0.05))
    other = peaks(DutyCycle(name="walk", file=file, lever_arm=0.05, torque_scale=1.5, time_scale=2))
    record = file.parsed(cycle_of, closed=True)
    assert one.push == pytest.approx(record.torque.max() / 0.05)
    assert one.pull == pytest.approx(-record.torque.min() / 0.05)
    assert one.travel == pytest.approx(0.05 * np.ptp(record.angle))
    assert math.isclose(other.push, 1.5 * one.push)
    assert math.isclose(other.speed, one.speed / 2)
    assert math.isclose(other.power_in, 0.75 * one.power_in)
    assert other.period == pytest.approx(2.2)
    with pytest.raises(InputError, match="there is no linkage"):
        peaks(DutyCycle(name="walk", file=file))
    axial = peaks(DutyCycle(name="rig", file=DataFile("a.csv", AXIAL), force_scale=2))
    assert (axial.push, axial.pull) == pytest.approx((1600, 1200))
    assert (axial.position_low, axial.position_high) == pytest.approx((0.02, 0.09))
    assert (axial.reversals, axial.torque) == (2, None)


def test_columns_under_ignore_and_samples_of_the_block(tmp_path):
    """Also the column of a known name; the file is written back as it was."""
    rows = AXIAL.splitlines()
    lines = [f"{rows[0]},emg [-],temperature [degC]", *(f"{row},x,900" for row in rows[1:])]
    block = BLOCK.replace("gait_knee.csv", "axial.csv").replace("torque_scale: 1.2\n", "\n")
    path = write(tmp_path, block)
    (tmp_path / "axial.csv").write_text("\n".join(lines))
    text = faults(path)
    assert 'axial.csv:1: unknown column "emg"' in text
    path = write(tmp_path, block.replace("starts: 2000", "ignore: [emg, temperature]"))
    (tmp_path / "axial.csv").write_text("\n".join(lines))
    design = read_design(path, overrides=[("duty.samples", "50")]).design
    cycle = design.duty.cycles[0]
    assert cycle.record.temperature is None
    assert design.duty.record(cycle).time.size == 4 * 13 + 1  # 49 steps in 4: 13 each
    (tmp_path / "again.yaml").write_text(to_yaml(design))
    assert read_design(tmp_path / "again.yaml").design == design


def test_unset_and_a_new_kind_of_file(place):
    """The block can be removed; keys that a new file makes meaningless are named together."""
    path = place / "knee.yaml"
    assert read_design(path, overrides=[("duty", None)]).design.duty is None
    text = faults(path, ("duty.cycles[walk].file", "axial.csv"))
    assert 'duty.cycles[walk].torque_scale has no meaning; add --unset "duty.cycles[walk]' in text
    changes = [("duty.cycles[walk].file", "axial.csv"), ("duty.cycles[walk].torque_scale", None)]
    assert not read_design(path, overrides=changes).design.duty.cycles[0].record.joint
