"""Claims about `simulate`, and scenarios in `check`, `schema` and `optimise`, at the terminal."""

from __future__ import annotations

import json
import re
import shutil

import numpy as np
import pytest
import yaml
from cli_runner import DESIGNS, run

import actuator_opt as ao

STEP = DESIGNS / "scenarios" / "knee_step.yaml"
SHORT = f"""\
name: short
design: {DESIGNS / "servo_knee.yaml"}
duration: 0.2 s
control:
  position:
    - shape: step
      value: 2 mm
      start: 0.02 s
requirements:
  overshoot:
    max: 5 %
"""


@pytest.fixture
def short(tmp_path):
    """A short scenario in a folder of its own."""
    file = tmp_path / "short.yaml"
    file.write_text(SHORT, encoding="utf-8")
    return file


def test_json_has_the_keys_of_the_contract():
    """Signals, servo, balance and second integrator; numbers only, SI."""
    result = run("simulate", str(STEP), "--verify", "--json")
    assert result.code == 0
    found = json.loads(result.out, parse_constant=pytest.fail)
    assert all(set(one) >= {"final", "min", "max"} for one in found["signals"].values())
    assert set(found["servo"]) >= {
        "rise_time", "settling_time", "overshoot", "steady_state_error",
    }  # fmt: skip
    assert set(found["balance"]) >= {"mass", "energy"}
    assert found["balance"]["mass"] < 1e-6
    assert found["balance"]["energy"] < 1e-6
    assert found["second_integrator"]["method"] == "radau"
    assert found["second_integrator"]["max_difference"] < 1e-4


def test_exit_codes_follow_the_requirements(short):
    """Met 0, missed 1, bad input 3; the file's line is told."""
    assert run("simulate", str(short), "--quiet").code == 0
    missed = run("simulate", str(short), "--set", "requirements.overshoot.max=0", "--set",
                 "control.law=pi")  # fmt: skip
    assert missed.code == 1
    assert "MISSED" in missed.out.upper()
    bad = run("simulate", str(short), "--set", "duration=-1 s")
    assert bad.code == 3
    assert "duration" in bad.err


def test_signals_go_to_csv(short, tmp_path):
    """Every signal with its unit, on even times; reading back gives the run."""
    file = tmp_path / "out.csv"
    run("simulate", str(short), "--csv", str(file), "--quiet")
    heads = file.read_text(encoding="utf-8").splitlines()[0].split(",")
    table = np.loadtxt(file, delimiter=",", skiprows=1)
    assert heads[0] == "t [s]"
    assert np.ptp(np.diff(table[:, 0])) < 1e-9
    own = ao.simulate(short)
    x = table[:, heads.index("position [mm]")]
    assert x[-1] == pytest.approx(1e3 * own.signals["position"][-1], rel=1e-5)


def test_the_scenario_is_not_overwritten(short):
    """--csv onto the scenario is refused, and the scenario stays."""
    before = short.read_bytes()
    assert run("simulate", str(short), "--csv", str(short)).code in (2, 3)
    assert short.read_bytes() == before


def test_a_record_is_laid_over_and_fitted(short, tmp_path):
    """A run with other oil and valve, written as a record, gives both back within their bounds."""
    made = ao.simulate(short, set={"fluid.air_content": 0.012, "valve.rated_flow": "8 l/min"})
    time, first = np.unique(made.time, return_index=True)
    rows = [
        f"{t:.6f},{p1 / 1e5:.4f},{p2 / 1e5:.4f},{1e3 * x:.5f}"
        for t, p1, p2, x in zip(
            time, *(made.signals[n][first] for n in ("pressure_a", "pressure_b", "position")),
            strict=True,
        )
    ]  # fmt: skip
    file = tmp_path / "bench.csv"
    file.write_text("t [s],p1 [bar],p2 [bar],x [mm]\n" + "\n".join(rows), encoding="utf-8")
    plain = json.loads(run("simulate", str(short), "--measured", str(file), "--json").out)
    assert plain["measured"]["residuals"]["position"]["rms"] > 1e-5
    found = json.loads(
        run("simulate", str(short), "--measured", str(file), "--fit", "air_content", "--fit",
            "valve_capacity", "--json").out
    )["measured"]["parameters"]  # fmt: skip
    assert found["air_content"]["value"] == pytest.approx(0.012, rel=0.05)
    assert found["valve_capacity"]["value"] == pytest.approx(0.8, rel=0.01)
    assert run("simulate", str(short), "--fit", "air_content").code == 2


def test_pages_carry_the_scenario(short, tmp_path):
    """PDF and PNG are written, with the scenario inside."""
    pytest.importorskip("typst")
    out = tmp_path / "out"
    result = run("simulate", str(short), "--report", "--out", str(out))
    assert {p.name for p in out.iterdir()} == {"short.pdf", "short.png"}
    assert result.err.count("wrote ") == 2
    from actuator_opt.rendering.attachments import read_attachment

    assert read_attachment(out / "short.pdf").source == SHORT


def test_check_and_schema_know_scenarios(short):
    """A good scenario has no faults, a bad one its line; the schema names its keys."""
    assert run("check", str(short)).code == 0
    short.write_text(SHORT.replace("duration", "duratoin"), encoding="utf-8")
    bad = run("check", str(short))
    assert bad.code == 3
    assert "short.yaml:3:1" in bad.err
    assert 'did you mean "duration"' in bad.err
    assert "duration" in json.loads(run("schema", "--scenario").out)["properties"]


@pytest.mark.long
def test_the_best_design_is_verified_in_time(short, tmp_path):
    """`optimise --verify-dynamics` tells both tiers of every dynamic requirement."""
    text = (DESIGNS / "servo_knee.yaml").read_text(encoding="utf-8")
    head, _, rest = text.partition("variables:\n")
    _, _, wishes = rest.partition("\n# The knee's requirements")
    wishes = wishes.partition("requirements:\n")[2]
    design = tmp_path / "gain.yaml"
    design.write_text(
        f"{head}variables:\n  control.gain:\n    lower: 100 V/m\n    upper: 1500 V/m\n\n"
        "requirements:\n  gain_margin:\n    min: 2\n  bandwidth:\n    min: 5 Hz\n\n"
        f"waivers:\n{wishes.partition('waivers:')[2].partition('objective:')[0]}\n"
        "objective:\n  maximise: bandwidth\n",
        encoding="utf-8",
    )
    result = run("optimise", str(design), "--starts", "1", "--verify-dynamics", str(short),
                 "--json")  # fmt: skip
    found = json.loads(result.out)["dynamics_verified"]
    rows = {row["metric"]: row for row in found["rows"]}
    assert set(rows) == {"gain_margin", "bandwidth", "overshoot"}
    for name in ("gain_margin", "bandwidth"):
        assert rows[name]["linear"] is not None
        assert rows[name]["value"] is not None
    assert result.code == (
        0 if found["met"] and json.loads(result.out)["status"] == "optimal" else 1
    )


@pytest.mark.long
def test_sensitivities_are_ranked(short):
    """The most effective parameter leads, and every effect says whether it is sure."""
    found = json.loads(run("simulate", str(short), "--sensitivity", "--json").out)["sensitivities"]
    sizes = [one["largest"] for one in found["parameters"]]
    assert sizes == sorted(sizes, reverse=True)
    assert {"control.gain", "valve.rated_flow"} & {one["path"] for one in found["parameters"][:6]}


@pytest.mark.parametrize(
    ("scenario", "design", "said"),
    [
        ("course_open_loop.yaml", "knee_bonded.yaml", "valve"),
        ("course_motor_velocity.yaml", "servo_knee.yaml", "replaces the cylinder"),
        ("course_valve_ramp.yaml", "servo_knee.yaml", "replaces the cylinder"),
        ("aalto_closed_ports.yaml", "servo_knee.yaml", "stroke"),
    ],
)
def test_a_scenario_that_a_design_cannot_do_is_refused_before_the_search(scenario, design, said):
    """One line at the scenario's place, exit 3, and no search is begun."""
    result = run("optimise", str(DESIGNS / design), "--verify-dynamics",
                 str(DESIGNS / "scenarios" / scenario))  # fmt: skip
    assert result.code == 3
    assert said in result.err
    assert result.out == ""


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        (["control.gain_factor=-1"], "must be >= 0"),
        (["stops.cushion.length=10 mm", "stops.cushion.open_area=1 cm^2",
          "stops.cushion.end_area=0 mm^2"], "never reach its stop"),
    ],
)  # fmt: skip
def test_values_without_sense_are_refused(short, changes, said):
    """What would turn the loop round or shut a cushion for good has one line."""
    result = run("simulate", str(short), *(f"--set={one}" for one in changes))
    assert result.code == 3
    assert said in result.err


def test_a_load_cylinder_needs_an_area():
    """A rod as thick as the bore, and a return above the supply, are named."""
    rig = DESIGNS / "scenarios" / "aalto_one_way_rig.yaml"
    for change, said in (("rod_diameter=40 mm", "not smaller than bore"),
                         ("return_pressure=500 bar", "not below supply_pressure")):  # fmt: skip
        result = run("simulate", str(rig), f"--set=load.cylinder.{change}")
        assert result.code == 3
        assert said in result.err


def test_the_unit_of_a_column_is_that_of_its_header(tmp_path):
    """A column in kN asked for in N is refused, not taken for N."""
    (tmp_path / "pull.csv").write_text("t [s],force [kN]\n0,2\n1,2\n")
    file = tmp_path / "a.yaml"
    file.write_text(SHORT + "load:\n  force:\n    - shape: record\n      file: pull.csv\n"
                    '      column: "force [N]"\n')  # fmt: skip
    result = run("simulate", str(file))
    assert result.code == 3
    assert "is in kN, not N" in result.err


def test_nothing_that_is_read_is_written_over(short, tmp_path):
    """The design a scenario names stays when --csv names it."""
    design = tmp_path / "knee_bonded.yaml"
    design.write_bytes((DESIGNS / "servo_knee.yaml").read_bytes())
    short.write_text(SHORT.replace(str(DESIGNS / "servo_knee.yaml"), "knee_bonded.yaml"))
    before = design.read_bytes()
    assert run("simulate", str(short), "--csv", str(design)).code == 3
    assert design.read_bytes() == before


def test_a_valve_between_empty_ports_runs():
    """Nothing flows over edges without a pressure drop; no traceback."""
    ramp = DESIGNS / "scenarios" / "course_valve_ramp.yaml"
    changes = ["held_ports.pressure_a=0 bar", "held_ports.pressure_b=0 bar"]
    result = run("simulate", str(ramp), *(f"--set={one}" for one in changes), "--json")
    found = json.loads(result.out)["signals"]
    assert found["flow_tank"]["max"] == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("pressure", ["0 bar", "200 bar"])
def test_a_start_away_from_rest_is_no_unstable_loop(short, pressure):
    """Margins are those where the valve holds the load, whatever pressures a run begins with."""
    rest, away = (
        json.loads(run("simulate", str(short), "--margins", "--json", *more).out)["controller"]
        for more in ((), (f"--set=initial.pressure_a={pressure}",
                          f"--set=initial.pressure_b={pressure}"))
    )  # fmt: skip
    assert away == rest
    assert away["stable"]


def test_a_load_that_no_pressure_holds_is_named(short):
    """A rule gives no gain then, in one line; a stated gain runs, and its margins say nothing."""
    motor = DESIGNS / "scenarios" / "course_motor_position.yaml"
    result = run("simulate", str(motor), "--set=motor.torque[0].value=22 N*m")
    assert result.code == 3
    assert "the valve cannot hold the load at the start" in result.err
    assert run("simulate", str(motor), "--set=motor.torque[0].value=20 N*m").code in (0, 1)
    short.write_text(SHORT + "load: {force: [{shape: constant, value: 12 kN}]}\n")
    result = run("simulate", str(short), "--margins")
    assert "margins of the linear loop are meaningless" in " ".join(result.out.split())


def test_a_run_that_ends_says_where_the_actuator_was(tmp_path):
    """10 kN m turn the joint to its dead point: time, place and cause in one line, exit 4.

    Pin to pin it is 192 mm long at its stop, |250 - 60| mm at the dead point: 2 mm behind it. Which
    of its bounces on the stop gets there turns on 0.01 % of the torque.
    """
    text = (DESIGNS / "servo_knee.yaml").read_text(encoding="utf-8")
    design = tmp_path / "linked.yaml"
    linkage = (
        "  mass: 2 kg\n  inertia: 0.5 kg*m^2\nlinkage:\n  base_radius: 250 mm\n"
        "  crank_radius: 60 mm\n  angle_offset: 10 deg\n"
    )
    design.write_text(text.replace("  mass: 20 kg\n", linkage), encoding="utf-8")
    file = tmp_path / "fall.yaml"
    file.write_text("name: fall\ndesign: linked.yaml\nduration: 1 s\nload:\n  torque:\n"
                    "    - {shape: constant, value: 10 kN*m}\n")  # fmt: skip
    result = run("simulate", str(file))
    assert result.code == 4
    place = re.match(r"at 0\.1\d+ s: .*position of the piston (-[\d.]+) mm, speed", result.err)
    assert -2.0 <= float(place[1]) < -1.95
    assert "pressure in chamber B -1.0" in result.err
    assert "the linkage reaches its dead" in result.err


@pytest.mark.parametrize(
    "name",
    [
        pytest.param(name, marks=[pytest.mark.long] if name.startswith("huang") else [])
        for name in sorted(one.name for one in DESIGNS.glob("*.yaml"))
    ],
)
def test_a_start_scenario_runs_around_every_design(name, tmp_path):
    """`init --scenario` writes beside a copy of the design what `check` and `simulate` take."""
    design, file = tmp_path / name, tmp_path / "more" / "step.yaml"
    design.write_bytes((DESIGNS / name).read_bytes())
    shutil.copytree(DESIGNS / "cycles", tmp_path / "cycles")
    file.parent.mkdir()
    result = run("init", "first step", "--scenario", str(design), "--out", str(file))
    assert result.code == 0
    assert yaml.safe_load(file.read_text(encoding="utf-8"))["design"] == f"../{name}"
    assert run("check", str(file)).code == 0
    found = json.loads(run("simulate", str(file), "--json").out)
    assert found["name"] == "first step"
    assert all(one["met"] for one in found["requirements"])


def test_a_start_scenario_and_a_start_design_are_one_or_the_other():
    """Both at once are refused in one line."""
    knee = str(DESIGNS / "knee_bonded.yaml")
    result = run("init", "--scenario", knee, "--from", knee)
    assert (result.code, result.out) == (2, "")
    assert "use only one of them" in result.err


def test_check_reads_a_scenario_from_standard_input():
    """Its faults stand at their lines of <stdin>; a good one has none."""
    text = SHORT.replace("duration: 0.2 s", "duration: -2 s")
    for given, code, said in ((SHORT, 0, "-: no faults"), (text, 3, "<stdin>:3:11: duration")):
        result = run("check", "-", stdin=given.encode())
        assert result.code == code
        assert result.err.startswith(said)


PUMP = """\
supply:
  type: fixed_pump
  volume: 100 ml
  flow: 8 l/min
  relief: {pressure: 190 bar, override: 15 bar, rated_flow: 20 l/min}
  accumulator: {gas_volume: 50 ml, precharge: 220 bar}
"""


def test_a_precharge_above_the_supply_is_an_empty_accumulator(short):
    """It gives no oil: the run is that without it, and the loop has its margins."""
    found = []
    for text in (PUMP, PUMP.replace(PUMP.splitlines()[-1] + "\n", "")):
        short.write_text(SHORT + text, encoding="utf-8")
        found.append(json.loads(run("simulate", str(short), "--margins", "--json").out))
    for name in ("rise_time", "peak_pressure"):
        values = [one["results"][name]["value"] for one in found]
        assert values[0] == pytest.approx(values[1], rel=1e-3)
    assert found[0]["controller"]["gain_margin"] == pytest.approx(
        found[1]["controller"]["gain_margin"], rel=1e-3
    )


def test_a_relief_valve_takes_the_pumps_flow(short):
    """A smaller one is refused; a start away from where both rest is told with the pressure."""
    short.write_text(SHORT + PUMP, encoding="utf-8")
    result = run("simulate", str(short), "--set=supply.flow=30 l/min")
    assert result.code == 3
    assert (
        "supply.relief.rated_flow: 20 l/min: less than the pump delivers (30 l/min)" in result.err
    )
    said = " ".join(run("simulate", str(short)).out.split())
    assert (
        "starts at 210 bar (supply.pressure), but pump and relief valve are in equilibrium near"
        in said
    )


def test_pressure_beyond_proof_and_coarse_samples_are_told(short):
    """Above the proof pressure a note says so; a rise within four samples has no figures."""
    short.write_text(SHORT, encoding="utf-8")
    said = " ".join(run("simulate", str(short), "--set=initial.pressure_a=350 bar").out.split())
    assert "The pressure in chamber A peaks at 350 bar, above the proof pressure of 315 bar" in said
    coarse = run("simulate", str(short), "--set=sample_time=15 ms", "--json")
    assert coarse.code == 1
    rise = json.loads(coarse.out)["results"]["rise_time"]
    assert rise["value"] is None
    assert "4 samples or fewer" in rise["why"]


def test_a_load_cylinder_without_leakage_leaves_the_loop_stable(short):
    """Its trapped oil is a neutral pole, not a growing one."""
    bench = (
        "load:\n  cylinder:\n    {bore: 25 mm, rod_diameter: 12 mm, stroke: 110 mm,"
        " dead_volume: 5 ml, supply_pressure: 100 bar,\n"
        "     valve: {rated_flow: 10 l/min, natural_frequency: 80 Hz}}\n"
    )
    short.write_text(SHORT + bench, encoding="utf-8")
    found = json.loads(run("simulate", str(short), "--margins", "--json").out)["controller"]
    assert found["stable"]
    assert found["gain_margin"] > 2


def test_runs_are_compared_on_a_page(short, tmp_path):
    """`write_comparison` draws runs of one scenario side by side, under its name."""
    trials = [ao.read_scenario(short, set={"load.mass": f"{kg} kg"}) for kg in (20, 40)]
    runs = [(name, ao.simulate(one)) for name, one in zip(("20 kg", "40 kg"), trials, strict=True)]
    files = ao.write_comparison(runs, trials[0], title="load", folder=tmp_path)
    assert [file.path.name for file in files] == ["short-compared.pdf", "short-compared.png"]
    assert all(file.path.stat().st_size > 10_000 for file in files)


def test_edges_that_leak_unlike_are_told_in_the_linear_model():
    """Its held pressures are those of alike edges; with alike ones nothing is said."""
    knee = str(DESIGNS / "servo_knee.yaml")
    unlike = " ".join(
        run("evaluate", "-v", knee, "--set=valve.tank_leakage_drop=20 bar").out.split()
    )
    assert "tank edges and supply edges leak differently" in unlike
    assert "leak differently" not in " ".join(run("evaluate", "-v", knee).out.split())
