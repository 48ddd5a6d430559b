"""Units by FMI 2.0: valid, equal to the simulation, and robust against their host."""

from __future__ import annotations

import ctypes
import shutil
import subprocess
import sys
import zipfile
from math import exp, pi, sin, sqrt
from pathlib import Path

import numpy as np
import pytest
from cli_runner import run
from fmi_host import ERROR, OK, REAL, Unit

import actuator_opt as ao
from actuator_opt.base.symbolic import program as programs
from actuator_opt.exports import fmu
from actuator_opt.exports.fmu import base_units

ROOT = Path(__file__).parents[2]
GCC = shutil.which("gcc") or shutil.which("cc") or shutil.which("clang")
recorded = pytest.mark.skipif(not programs.AVAILABLE, reason="the machine was not built")
compiled = pytest.mark.skipif(
    GCC is None or sys.platform != "linux", reason="no C compiler, or not Linux"
)
pytestmark = [recorded, compiled]
COURSE = ROOT / "designs/course_cylinder.yaml"
KNEE = ROOT / "designs/servo_knee.yaml"
SERVO = ROOT / "designs/scenarios/course_position_servo.yaml"
FRICTION = """
friction:
  model: {model}
  coulomb: 500 N
  static: 1000 N
  stribeck_speed: 20 mm/s
  viscous: 1000 N*s/m
"""
STOPS = """
name: against both stops
design: {design}
duration: 1.6 s
sample_time: 1 ms
initial: {{position: 350 mm}}
signal:
  - {{shape: constant, value: 5 V}}
  - {{shape: pulse, value: -15 V, start: 0.3 s, end: 1.5 s}}
"""
OPEN = """
name: open loop
design: {design}
duration: 0.3 s
sample_time: 1 ms
initial: {{position: 200 mm}}
signal:
  - {{shape: constant, value: 2 V}}
load:
  force: [{{shape: constant, value: 100 N}}]
"""


@pytest.fixture(autouse=True)
def quickly_compiled(request, monkeypatch):
    """The compiler optimises nothing, which takes most of its time, except for the host."""
    if request.function is not test_an_established_host:
        flags = ["-O0" if flag == "-O2" else flag for flag in fmu.FLAGS]
        monkeypatch.setattr(fmu, "FLAGS", tuple(flags))


def written(folder, text, *, design=COURSE, model="stribeck", name="case.yaml"):
    """A scenario file."""
    file = folder / name
    file.write_text(text.format(design=design) + FRICTION.format(model=model), "utf-8")
    return file


def exported(scenario, folder, design=COURSE):
    """The unit of a scenario."""
    (file,) = ao.export(design, scenario=scenario, formats=["fmu"], folder=folder)
    assert file.note == ""
    return file.path


def opened(scenario, folder, design=COURSE, **options):
    """The unit of a scenario, loaded."""
    return Unit(exported(scenario, folder, design), folder, **options)


def simulated(scenario, names, **options):
    """Times and signals of a simulation at single samples; jumps, which have two, are left out."""
    result = ao.simulate(scenario, **options)
    times, first, count = np.unique(result.time, return_index=True, return_counts=True)
    keep = first[count == 1]
    return times[count == 1], np.array([result.signals[name][keep] for name in names]).T


def assert_close(found, expected, share):
    """Each column agrees within a share of its span."""
    difference = np.max(np.abs(found - expected), axis=0)
    assert np.all(difference <= share * np.ptp(expected, axis=0)), difference


# ---- the file ----


def test_the_archive(tmp_path):
    """Sources without a warning, a library, documentation; equal bytes; the GUID is in both."""
    file = exported(SERVO, tmp_path)
    again = exported(SERVO, tmp_path / "again")
    assert file.read_bytes() == again.read_bytes()
    name = "course_position_servo"
    with zipfile.ZipFile(file) as archive:
        assert archive.namelist() == [
            "modelDescription.xml", f"sources/{name}.c", "documentation/index.html",
            f"binaries/linux64/{name}.so",
        ]  # fmt: skip
        archive.extractall(tmp_path)
    unit = Unit(file, tmp_path)
    assert f'"{unit.xml.get("guid")}"' in (tmp_path / f"sources/{name}.c").read_text("ascii")
    command = [GCC, "-std=c99", "-Wall", "-Wextra", "-pedantic", "-Werror", "-O1", "-c"]
    for prefix in ((), ("-DFMI2_FUNCTION_PREFIX=knee_",)):
        subprocess.run(
            [*command, *prefix, f"sources/{name}.c", "-o", "unit.o"],
            cwd=tmp_path, check=True, timeout=300,
        )  # fmt: skip
    other = exported(KNEE.parent / "scenarios/knee_step.yaml", tmp_path, KNEE)
    assert Unit(other, tmp_path).xml.get("guid") != unit.xml.get("guid")


def test_variables_of_a_servo(tmp_path):
    """Inputs, parameters by PATH and outputs, with units; starts are those of the scenario."""
    unit = opened(SERVO, tmp_path)
    starts = {
        name: (x.get("causality"), x[0].get("unit"), float(x[0].get("start", "nan")))
        for name, x in unit.variables.items()
    }
    assert starts["reference"] == ("input", "m", pytest.approx(0.2))
    assert starts["supply.pressure"] == ("input", "Pa", 1e7)
    assert starts["supply.return_pressure"] == ("input", "Pa", 0.0)
    assert starts["load.force"] == ("input", "N", 0.0)
    assert starts["load.mass"] == ("parameter", "kg", 234.0)
    assert starts["initial.position"] == ("parameter", "m", pytest.approx(0.2))
    gain = ao.simulate(SERVO).tuned.gains.proportional_gain
    assert starts["control.position_gain"] == ("parameter", "V/m", pytest.approx(gain))
    outputs = {name for name, x in starts.items() if x[0] == "output"}
    assert outputs >= {
        "position",
        "speed",
        "pressure_a",
        "pressure_b",
        "flow_a",
        "friction",
        "spool",
    }
    bases = {x.get("name"): dict(x[0].attrib) for x in unit.xml.find("UnitDefinitions")}
    assert bases["Pa"] == {"kg": "1", "m": "-1", "s": "-2"}
    assert base_units("N*m*s/rad") == {"kg": 1, "m": 2, "s": -1, "rad": -1}


def test_hostile_names(tmp_path):
    """Names of scenario and file with marks of XML, C and templates."""
    text = OPEN.replace("name: open loop", "name: 'a@b@c @guid@ <&> \"x\" */ \\ µ %s'")
    file = written(tmp_path, text, name="7 µ-valve.yaml")
    (made,) = ao.export(COURSE, scenario=file, formats=["fmu"], folder=tmp_path)
    assert made.path.name == "design_7_valve.fmu"
    unit = Unit(made.path, tmp_path).begin()
    assert unit.xml.get("description").startswith("a@b@c ")
    assert unit.step(0.0, 0.01) == OK


def test_without_a_compiler(tmp_path, monkeypatch):
    """Sources only, and a note."""
    monkeypatch.setattr(fmu.shutil, "which", lambda name: None)
    result = run(
        "export", COURSE, "--scenario", SERVO, "--format", "fmu", "--out", tmp_path, "--json"
    )
    (file,) = result.json["files"]
    assert "no C compiler" in file["note"]
    with zipfile.ZipFile(file["path"]) as archive:
        assert not [name for name in archive.namelist() if name.startswith("binaries")]
    result = run("export", COURSE, "--scenario", SERVO, "--format", "fmu", "--out", tmp_path)
    assert "sources only: no C compiler" in result.err
    assert result.code == 0


def test_a_compiler_that_fails(tmp_path, monkeypatch):
    """Sources only; the note has the compiler's own words."""
    monkeypatch.setattr(fmu, "FLAGS", ("-no-such-flag",))
    (file,) = ao.export(COURSE, scenario=SERVO, formats=["fmu"], folder=tmp_path)
    assert "the C compiler failed" in file.note
    assert "no-such-flag" in file.note


def test_a_unit_needs_a_scenario(tmp_path):
    """One line, no file."""
    result = run("export", COURSE, "--format", "fmu", "--out", tmp_path / "out")
    assert result.code == 2
    assert "it needs a scenario; add --scenario FILE" in result.err
    assert result.err.count("\n") == 1
    assert not (tmp_path / "out").exists()


@pytest.mark.long
def test_a_scenario_alone_brings_its_design(tmp_path):
    """The unit equals that of `--scenario` with the same design; `--set` changes either file."""
    (tmp_path / "one").mkdir()
    own = exported(SERVO, tmp_path / "one")
    result = run("export", SERVO, "--format", "fmu", "--out", tmp_path / "two")
    assert result.code == 0
    assert (tmp_path / "two" / own.name).read_bytes() == own.read_bytes()
    (again,) = ao.export(ao.read_scenario(SERVO), formats=["fmu"], folder=tmp_path / "three")
    assert again.path.read_bytes() == own.read_bytes()
    sets = ("--set", "load.mass=90 kg", "--set", "duration=3 s")
    assert run("export", SERVO, "--format", "c", *sets, "--out", tmp_path / "four").code == 0
    (changed,) = (tmp_path / "four").glob("*.c")
    files = ao.export(SERVO, formats=["c"], folder=tmp_path / "five")
    assert changed.read_bytes() != next(f.path for f in files if f.path.suffix == ".c").read_bytes()


@pytest.mark.parametrize(
    ("text", "words", "code", "message"),
    [
        ("name: x\nduration: 1 s\n", (), 3, 'design: missing; add e.g. "design: knee.yaml"'),
        (f"name: x\nduration: 1 s\ndesign: {COURSE}\n", ("--format", "step"), 2,
         "the equations of a scenario have no STEP file; use --format c or fmu"),
        (f"name: x\nduration: 1 s\ndesign: {COURSE}\n", ("--plugin", __file__), 2,
         "--plugin: not with a scenario alone; give the design, and the scenario by --scenario"),
    ],
)  # fmt: skip
def test_a_scenario_alone_that_cannot_be_written(text, words, code, message, tmp_path):
    """One line with what to write, no file."""
    file = tmp_path / "run.yaml"
    file.write_text(text, "utf-8")
    result = run("export", file, "--format", "fmu", *words, "--out", tmp_path / "out")
    assert result.code == code
    assert message in result.err
    assert not (tmp_path / "out").exists()


# ---- against the simulation ----


@pytest.mark.parametrize(
    ("scenario", "design"),
    [
        pytest.param(SERVO, COURSE, marks=pytest.mark.long),
        (KNEE.parent / "scenarios/knee_step.yaml", KNEE),
        ("stops", COURSE),
    ],
)
def test_an_established_host(scenario, design, tmp_path):
    """FMPy finds no fault; its runs equal `simulate`, without any input and parameter set.

    In model exchange, its CVode integrates.
    """
    pytest.importorskip("fmpy", reason="FMPy is not installed: pip install actuator-opt[fmu]")
    from fmpy import simulate_fmu
    from fmpy.validation import validate_fmu

    file = written(tmp_path, STOPS) if scenario == "stops" else scenario
    unit = exported(file, tmp_path, design)
    assert validate_fmu(str(unit)) == []
    names = ["position", "pressure_a", "pressure_b"]
    times, expected = simulated(file, names)
    result = ao.simulate(file)
    step = result.scenario.sample_time
    for kind in ("CoSimulation", "ModelExchange"):
        rows = simulate_fmu(
            str(unit), fmi_type=kind, output=names, step_size=step, output_interval=step,
            stop_time=result.scenario.duration, relative_tolerance=1e-6,
        )  # fmt: skip
        rows = rows[np.append(True, np.diff(rows["time"]) > 1e-9)]
        shared = np.min(np.abs(times[:, None] - rows["time"]), axis=1) < 1e-9
        assert np.mean(shared) > 0.9
        at = np.searchsorted(rows["time"], times[shared] - 1e-9)
        found = np.array([rows[name][at] for name in names]).T
        assert_close(found[:, :1], expected[shared, :1], 1e-4)
        assert_close(found[:, 1:], expected[shared, 1:], 1e-3)


@pytest.mark.parametrize("model", ["stribeck", "lugre"])
def test_both_stops(model, tmp_path):
    """Steps of 7 ms, which are longer than contacts: as `simulate`, which restarts at each."""
    file = written(tmp_path, STOPS, model=model)
    unit = opened(file, tmp_path).begin()
    names = ("position", "speed", "pressure_a", "pressure_b", "stop_force")
    result = ao.simulate(file)
    assert len(result.events) >= 2
    times = np.append(0.0, np.arange(7e-3, 1.59, 7e-3))
    found = unit.run(times, *names)
    for k, name in enumerate(names[:4]):
        expected = np.interp(times, result.time, result.signals[name])
        assert np.max(np.abs(found[:, k] - expected)) <= 1e-3 * np.ptp(expected), name
    assert np.max(np.abs(found[:, 4])) > 1e3


def test_a_valve_by_its_data_sheet(tmp_path):
    """A flow curve from a file, hysteresis and threshold: the unit moves as `simulate`."""
    rows = "0,0.1", "4,0.1", "8,0.6", "20,6", "50,17", "100,40"
    (tmp_path / "curve.csv").write_text("\n".join(("signal [%],q [l/min]", *rows)), "utf-8")
    data = "  flow_curve: curve.csv\n  hysteresis: 5 %\n  threshold: 2 %\n"
    lines = COURSE.read_text("utf-8").splitlines(keepends=True)
    kept = [line for line in lines if not line.startswith(("  rated_flow", "  leakage_"))]
    design = tmp_path / "valve.yaml"
    design.write_text("".join(kept).replace("valve:\n", f"valve:\n{data}", 1), "utf-8")
    file = written(tmp_path, STOPS, design=design)
    unit = opened(file, tmp_path, design).begin()
    result = ao.simulate(file)
    stated = {value.name: value.value for value in result.basis.values}
    assert stated["valve_hysteresis"] == pytest.approx(0.5)
    assert stated["valve_threshold"] == pytest.approx(0.2)
    names = ("position", "pressure_a", "pressure_b", "spool")
    times = np.append(0.0, np.arange(7e-3, 1.59, 7e-3))
    found = unit.run(times, *names)
    for k, name in enumerate(names):
        expected = np.interp(times, result.time, result.signals[name])
        assert np.max(np.abs(found[:, k] - expected)) <= 1e-3 * np.ptp(expected), name


def test_the_spool_has_a_closed_form(tmp_path):
    """A step of the signal moves the spool as a damped oscillator of second order."""
    text = OPEN.replace("value: 2 V", "value: 3 V")
    unit = opened(written(tmp_path, text), tmp_path).begin()
    valve = ao.read(COURSE).design.valve
    omega, zeta = 2 * pi * valve.natural_frequency, valve.damping_ratio
    damped = omega * sqrt(1 - zeta * zeta)
    times = np.linspace(0.0, 0.02, 21)
    found = unit.run(times, "spool")[:, 0]
    lag = zeta / sqrt(1 - zeta * zeta)
    expected = [
        3 * (1 - exp(-zeta * omega * t) * (np.cos(damped * t) + lag * sin(damped * t)))
        for t in times
    ]
    assert np.max(np.abs(found - expected)) < 3e-5


@pytest.mark.parametrize(
    ("name", "value", "text"),
    [
        ("initial.position", 0.15, "150 mm"),
        pytest.param("initial.pressure_a", 2e6, "20 bar", marks=pytest.mark.long),
        ("initial.speed", 0.1, "0.1 m/s"),
        ("load.stiffness", 2e4, "20 N/mm"),
        pytest.param("load.damping", 500.0, "500 N*s/m", marks=pytest.mark.long),
        pytest.param("friction.viscous", 200.0, "200 N*s/m", marks=pytest.mark.long),
        ("load.force", 800.0, "800 N"),
        ("signal", -1.5, "-1.5 V"),
        pytest.param("valve.offset", 0.1, "0.1 V", marks=pytest.mark.long),
        ("supply.return_pressure", 3e5, "3 bar"),
    ],
)
def test_inputs_and_parameters_act_as_in_the_scenario(name, value, text, tmp_path):
    """A value that the host sets equals the value in the file, at equal initial pressures."""
    case = OPEN.replace("200 mm}}", "200 mm, pressure_a: 40 bar, pressure_b: 60 bar}}")
    file = written(tmp_path, case)
    unit = opened(file, tmp_path)
    assert unit.setup() == OK
    assert unit.set(name, value) == OK
    unit.call("EnterInitializationMode")
    unit.call("ExitInitializationMode")
    names = ("position", "pressure_a", "pressure_b")
    path = {"load.force": "load.force[0].value", "signal": "signal[0].value"}.get(name, name)
    times, expected = simulated(file, names, set={path: text})
    assert_close(unit.run(times, *names), expected, 1e-4)
    before = simulated(file, names)[1]
    assert np.any(np.abs(expected - before) > 1e-3 * np.ptp(before, axis=0))


def test_mass_gain_and_reference(tmp_path):
    """Free running first: the mass, the gain and the reference act as in the files."""
    unit = opened(SERVO, tmp_path).begin(load__mass=150.0, control__position_gain=40.0)
    names = ("position", "pressure_a")
    changes = {"load.mass": "150 kg", "control.tuning": "stated", "control.position_gain": "40 V/m"}
    trial = tmp_path / "light.yaml"
    text = SERVO.read_text("utf-8").replace("../course_cylinder.yaml", str(COURSE))
    trial.write_text(text.replace("duration: 3 s", "duration: 1.3 s"), "utf-8")
    times, expected = simulated(trial, names, set=changes)
    found = unit.run(times, *names)
    assert_close(found[:, :1], expected[:, :1], 2e-2)  # bristles keep the damping of 234 kg
    assert unit.set("reference", 0.21) == OK
    unit.run(times[-1] + np.linspace(0.0, 3.0, 300), "position")
    assert unit.get("reference")[0] == 0.21
    assert abs(unit.get("position")[0] - 0.21) < 1e-3


def test_a_record_is_followed(tmp_path):
    """Values between the samples of a file, and its bends."""
    times = np.linspace(0.0, 0.3, 13)
    rows = ["time [s],signal [V]", *(f"{t},{2 * np.sin(30 * t)}" for t in times)]
    (tmp_path / "course.csv").write_text("\n".join(rows), "utf-8")
    text = OPEN.replace(
        "{{shape: constant, value: 2 V}}",
        "{{shape: record, file: course.csv, column: signal}}",
    )
    file = written(tmp_path, text)
    unit = opened(file, tmp_path).begin()
    at, expected = simulated(file, ("position", "signal", "pressure_a"))
    assert_close(unit.run(at, "position", "signal_out", "pressure_a"), expected, 1e-4)
    assert unit.get("signal")[0] == pytest.approx(2 * np.sin(9.0))


# ---- the host ----


def test_a_state_is_stored_and_restored(tmp_path):
    """In memory and as bytes, with the same numbers after it; nothing leaks."""
    unit = opened(written(tmp_path, STOPS), tmp_path).begin()
    unit.run(np.linspace(0.0, 0.4, 101), "position")
    state = ctypes.c_void_p()
    assert unit.call("GetFMUstate", ctypes.byref(state)) == OK
    times = np.linspace(0.4, 1.0, 61)
    first = unit.run(times, "position", "pressure_a")
    size = ctypes.c_size_t()
    assert unit.call("SerializedFMUstateSize", state, ctypes.byref(size)) == OK
    stored = ctypes.create_string_buffer(size.value)
    assert unit.call("SerializeFMUstate", state, stored, size) == OK
    assert unit.call("SetFMUstate", state) == OK
    assert np.array_equal(unit.run(times, "position", "pressure_a"), first)
    other = ctypes.c_void_p()
    assert unit.call("DeSerializeFMUstate", stored, size, ctypes.byref(other)) == OK
    assert (
        unit.call("DeSerializeFMUstate", stored, ctypes.c_size_t(3), ctypes.byref(other)) == ERROR
    )
    assert unit.call("Reset") == OK
    assert unit.call("SetFMUstate", other) == OK
    assert np.array_equal(unit.run(times, "position", "pressure_a"), first)
    for held in (state, other):
        assert unit.call("FreeFMUstate", ctypes.byref(held)) == OK
        assert held.value is None
    unit.close()
    assert unit.live == 0


def test_two_units_in_one_process(tmp_path):
    """They share nothing; a reset starts anew."""
    file = written(tmp_path, OPEN)
    one = opened(file, tmp_path).begin()
    two = Unit(tmp_path / "case.fmu", tmp_path).begin(signal=-2.0)
    times = np.linspace(0.0, 0.3, 31)
    rows = []
    for k in range(30):
        assert one.step(times[k], times[k + 1] - times[k]) == OK
        assert two.step(times[k], times[k + 1] - times[k]) == OK
        rows.append(one.get("position")[0])
    assert one.get("position")[0] > 0.205 > 0.195 > two.get("position")[0]
    assert one.call("Reset") == OK
    assert np.array_equal(one.begin().run(times, "position")[1:, 0], rows)


def test_faults_of_the_host(tmp_path):
    """An error and a message, never a crash; the unit goes on after it."""
    unit = opened(written(tmp_path, OPEN), tmp_path)
    assert unit.step(0.0, 1e-3) == ERROR
    assert "not after the initialisation" in unit.said[-1]
    assert unit.set("signal", float("nan")) == ERROR
    assert "not finite" in unit.said[-1]
    assert unit.setup(tolerance=2.0) == ERROR
    assert unit.call("ExitInitializationMode") == ERROR
    unit.begin()
    for time, size, words in (
        (0.5, 1e-3, "but the unit is at 0 s"), (0.0, -1.0, "negative"), (0.0, np.nan, "not finite"),
        (0.0, np.inf, "not finite"),
    ):  # fmt: skip
        assert unit.step(time, size) == ERROR
        assert words in unit.said[-1]
    assert unit.set("initial.position", 0.1) == ERROR
    assert "fixed after the start" in unit.said[-1]
    assert unit.set("position", 0.1) == ERROR
    assert "no input and no parameter" in unit.said[-1]
    value, count = (REAL * 1)(), ctypes.c_size_t(1)
    for reference in (999, 2**32 - 1):
        assert unit.call("GetReal", (ctypes.c_uint * 1)(reference), count, value) == ERROR
    assert unit.call("GetReal", None, count, None) == ERROR
    assert unit.call("GetBoolean", (ctypes.c_uint * 1)(0), count, value) == ERROR
    assert unit.call("GetInteger", None, ctypes.c_size_t(0), None) == OK
    assert unit.call("CancelStep") == ERROR
    unit.run(np.linspace(0.0, 0.1, 11), "position")
    assert unit.call("Terminate") == OK
    assert unit.step(0.1, 1e-3) == ERROR
    unit.close()
    assert unit.live == 0
    assert unit.library.fmi2DoStep(None, REAL(0), REAL(1), 1) == ERROR


def test_equations_without_a_solution_are_an_error(tmp_path):
    """A pressure beyond all numbers: the step fails with a message, and the last state remains."""
    unit = opened(written(tmp_path, OPEN), tmp_path).begin(initial__pressure_a=1e300)
    assert unit.step(0.0, 0.1) == ERROR
    assert "time step" in unit.said[-1]
    assert np.isfinite(unit.get("position")).all()


def test_wrong_units_are_refused(tmp_path):
    """Another GUID, no memory: no instance, and no leak."""
    file = written(tmp_path, OPEN)
    unit = opened(file, tmp_path, guid="{0}")
    assert unit.component is None
    assert "GUID" in unit.said[-1]
    assert unit.live == 0
    again = tmp_path / "case.fmu"
    assert Unit(again, tmp_path, memory=False).component is None


def test_model_exchange_by_euler(tmp_path):
    """States, derivatives and indicators in a host's own loop; faults of the host are errors."""
    unit = opened(written(tmp_path, OPEN), tmp_path, kind=0).begin()
    size = len([name for name in unit.variables if name.startswith("state.")])
    count, numbers = ctypes.c_size_t(size), (REAL * size)()
    info = (ctypes.c_int * 8)()
    assert unit.step(0.0, 1e-3) == ERROR
    assert "model exchange" in unit.said[-1]
    assert unit.call("NewDiscreteStates", info) == OK
    assert unit.call("EnterContinuousTimeMode") == OK
    assert unit.call("GetContinuousStates", numbers, count) == OK
    states, slopes = np.array(numbers), (REAL * size)()
    assert unit.call("GetNominalsOfContinuousStates", numbers, count) == OK
    assert np.all(np.array(numbers) > 0)
    for k in range(4000):  # Euler, short enough for the oil
        assert unit.call("SetTime", REAL(5e-6 * k)) == OK
        assert unit.call("SetContinuousStates", (REAL * size)(*states), count) == OK
        assert unit.call("GetDerivatives", slopes, count) == OK
        states = states + 5e-6 * np.array(slopes)
    named = [name for name in unit.variables if name.startswith("der(state.")]
    assert np.array_equal(unit.get(*named), np.array(slopes))
    other = Unit(tmp_path / "case.fmu", tmp_path).begin()
    other.run([0.0, 0.02], "position")
    expected = other.get("state.position", "state.speed", "state.pressure_a", "state.pressure_b")
    order = [list(unit.variables).index(f"state.{x}") for x in ("position", "speed")]
    first = min(list(unit.variables).index(name) for name in unit.variables if "state." in name)
    assert np.allclose(states[[k - first for k in order]], expected[:2], rtol=2e-2)
    indicators = (REAL * 2)()
    assert unit.call("GetEventIndicators", indicators, ctypes.c_size_t(2)) == OK
    assert indicators[0] == pytest.approx(-unit.get("position")[0])
    assert unit.call("GetEventIndicators", indicators, ctypes.c_size_t(3)) == ERROR
    assert unit.call("GetDerivatives", slopes, ctypes.c_size_t(size + 1)) == ERROR
    assert unit.call("SetTime", REAL(np.nan)) == ERROR
    bad = (REAL * size)(*(np.nan for _ in range(size)))
    assert unit.call("SetContinuousStates", bad, count) == ERROR
    assert other.call("GetDerivatives", slopes, count) == ERROR
    assert "only for model exchange" in other.said[-1]
