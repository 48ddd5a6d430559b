"""C files: compiled, they equal the models; hostile names; designs that cannot be written."""

from __future__ import annotations

import ctypes
import re
import shutil
import subprocess
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from cli_runner import bench, run

import actuator_opt as ao
from actuator_opt.base.numeric import STEP
from actuator_opt.base.symbolic import function, jacobian, program as programs
from actuator_opt.base.symbolic.expression import needed
from actuator_opt.design.materials import load_library
from actuator_opt.evaluation import compute
from actuator_opt.evaluation.kernel import governing
from actuator_opt.exports.c import constants, file_word, quoted, remark, table
from actuator_opt.exports.c_design import design_files
from actuator_opt.optimisation.actuator import build, variant
from actuator_opt.simulation.assemble import assemble
from actuator_opt.simulation.linear import tune
from actuator_opt.studies.plant import plant

ROOT = Path(__file__).parents[2]
GCC = shutil.which("gcc") or shutil.which("cc") or shutil.which("clang")
WARNINGS = ("-O1", "-Wall", "-Wextra", "-pedantic", "-Werror")
recorded = pytest.mark.skipif(not programs.AVAILABLE, reason="the machine was not built")
compiled = pytest.mark.skipif(GCC is None, reason="no C compiler")
NUMBERS = ctypes.POINTER(ctypes.c_double)


def library(folder, name):
    """A C file compiled without a warning, as a library."""
    target = folder / f"{name}.so"
    command = [GCC, "-std=c99", *WARNINGS, "-shared", "-fPIC", f"{name}.c", "-o", target, "-lm"]
    subprocess.run(command, cwd=folder, check=True, capture_output=True, text=True, timeout=300)
    return ctypes.CDLL(str(target))


class Compiled:
    """The functions of an exported design; work space and results begin as NaN."""

    def __init__(self, folder, name):
        upper = name.upper()
        self.name, self.library = name, library(folder, name)
        sizes = ("INPUTS", "VARIABLES", "OUTPUTS", "FIRST_LIMIT", "VALUES_WORK", "GRADIENTS_WORK")
        lines = [f'printf("%d ", (int){upper}_{size});' for size in sizes] + [
            f"""for (int k = 0; k < {upper}_{size}; k++) {{
            printf("\\n%s\\t%s\\t", {name}_{kind}[k].name, {name}_{kind}[k].unit);
            printf("%.17g", {name}_{kind}[k].present); }}"""
            for size, kind in (("INPUTS", "inputs"), ("OUTPUTS", "outputs"))
        ]
        code = f'#include <stdio.h>\n#include "{name}.h"\nint main(void) {{ {"".join(lines)} }}\n'
        (folder / "show.c").write_text(code, "ascii")
        command = [GCC, *WARNINGS, "show.c", f"{name}.c", "-o", "show", "-lm"]
        subprocess.run(command, cwd=folder, check=True, capture_output=True, text=True)
        done = subprocess.run([folder / "show"], capture_output=True, check=True).stdout
        head, *rows = done.decode("utf-8").splitlines()
        self.count, self.variables, self.results, self.first, self.work, self.more = map(
            int, head.split()
        )
        entries = [row.split("\t") for row in rows]
        self.inputs, self.outputs = entries[: self.count], entries[self.count :]
        self.present = np.array([float(entry[2]) for entry in self.inputs])
        self.expected = np.array([float(entry[2]) for entry in self.outputs])

    def values(self, point):
        """Return code and outputs."""
        outputs, work = np.full(self.results, np.nan), np.full(self.work, np.nan)
        code = getattr(self.library, f"{self.name}_values")(*map(pointer, (point, outputs, work)))
        return code, outputs

    def gradients(self, point):
        """Return code, outputs and gradients."""
        outputs, work = np.full(self.results, np.nan), np.full(self.more, np.nan)
        slopes = np.full((self.results, self.variables), np.nan)
        run = getattr(self.library, f"{self.name}_gradients")
        return run(*map(pointer, (point, outputs, slopes, work))), outputs, slopes


def pointer(values):
    """Address of an array of doubles."""
    return values.ctypes.data_as(NUMBERS)


def exported(name, folder):
    """The compiled file of a shipped design, exported from the command line."""
    result = run(
        "export", ROOT / f"designs/{name}.yaml", "--format", "c", "--out", folder, "--json"
    )
    assert [Path(file["path"]).name for file in result.json["files"]] == [f"{name}.h", f"{name}.c"]
    return Compiled(folder, name)


@recorded
@compiled
@pytest.mark.parametrize(
    "name",
    [
        "knee_bonded",
        pytest.param("steel_baseline", marks=pytest.mark.long),
        pytest.param("servo_knee", marks=pytest.mark.long),
    ],
)
def test_the_compiled_file_equals_the_models(name, tmp_path):
    """At 200 random points of the box: values to 1e-12, gradients to 1e-9, NaN at the same places.

    Expected are the models through NumPy and their complex steps.
    """
    made = exported(name, tmp_path)
    subject = ao.read(ROOT / f"designs/{name}.yaml").subject()
    actuator = replace(build(subject), scales=())  # margins as reported, not as solved
    names = [entry[0] for entry in made.outputs]
    limits = [names.index(row.label, made.first) for row in actuator.rows]
    low, high = actuator.problem.lower[:, None], actuator.problem.upper[:, None]
    points = low + (high - low) * np.random.default_rng(23).random((len(low), 200))
    wide = points[:, ::10]
    steps = np.repeat(wide, len(low), axis=1) + 1j * STEP * np.tile(np.eye(len(low)), len(wide.T))
    with np.errstate(all="ignore"):
        plain, stepped = actuator.by_models(points, {}), actuator.by_models(steps, {})
    shape = (len(actuator.rows) + 1, len(wide.T), len(low))
    slopes = np.concatenate([stepped.objective[None], stepped.constraints]).imag / STEP
    slopes = slopes.reshape(shape)
    computed = 0
    for k, point in enumerate(points.T):
        inputs = np.append(point, made.present[len(low) :])
        outside, outputs = made.values(inputs)
        if outside:
            assert np.isnan(outputs).all()
            continue
        computed += 1
        spare = np.append(outputs[0], [bounded(outputs[at]) for at in limits])
        expected = np.append(plain.objective[k], plain.constraints[:, k])
        np.testing.assert_allclose(spare, expected, rtol=1e-12, atol=1e-12)
        if k % 10 == 0:
            again, same, gradients = made.gradients(inputs)
            assert again == 0
            np.testing.assert_array_equal(same, outputs)
            mine = np.stack([gradients[0], *(
                gradients[at] / (1 + max(outputs[at], 0.0)) ** 2 for at in limits
            )])  # fmt: skip
            theirs = slopes[:, k // 10]
            sound = np.isfinite(theirs) & np.isfinite(mine)
            assert sound[np.isfinite(expected)].all()
            room = 1e-9 * np.maximum(1.0, np.abs(theirs))
            assert np.all(np.abs(mine - theirs)[sound] <= room[sound])
    assert computed >= 140


def bounded(margin):
    """A margin as the search sees it."""
    return 1.0 if margin > 1e9 else margin / (1 + margin) if margin > 0 else margin


@pytest.mark.long
@recorded
@compiled
def test_inputs_are_the_numbers_of_the_design(tmp_path):
    """Metrics are those of `evaluate`; each changed input gives those of the changed design."""
    made = exported("knee_bonded", tmp_path)
    subject, stock = ao.read(ROOT / "designs/knee_bonded.yaml").subject(), load_library()
    names = [entry[0] for entry in made.outputs[1 : made.first]]
    evaluated = ao.evaluate(ROOT / "designs/knee_bonded.yaml").to_dict()["metrics"]
    for name, unit, value in made.outputs[1 : made.first]:
        if evaluated[name]["value"] is not None:
            assert float(value) == pytest.approx(evaluated[name]["value"], rel=1e-12), name
            assert unit == evaluated[name]["unit"]
    assert len(made.inputs) > 150
    for k in range(0, len(made.inputs), 5):
        point = made.present.copy()
        point[k] *= 1.001
        code, outputs = made.values(point)
        changed = variant(subject, {made.inputs[k][0]: point[k]}, stock)
        with np.errstate(all="ignore"):
            numbers = changed.values()
            computed = compute(changed, numbers).computed
            expected = [governing(name, computed, numbers, changed) for name in names]
        assert code == 0
        np.testing.assert_allclose(
            outputs[1 : made.first], np.squeeze(expected), rtol=1e-10, err_msg=made.inputs[k][0]
        )


@pytest.mark.long
@recorded
@compiled
def test_another_branch_is_reported(tmp_path):
    """Where the models take another branch, the code is 1 and every result is NaN.

    No dimension of the knee leads to another branch, so an answer is inverted in the file.
    """
    made = exported("knee_bonded", tmp_path)
    assert made.gradients(made.present)[0] == 0
    file = tmp_path / "knee_bonded.c"
    text, count = re.subn(r"(ANSWERS\[\d*\] = \{\s*)1", r"\g<1>0", file.read_text("ascii"), count=1)
    assert count == 1
    other = tmp_path / "other"  # of another path, or the loader takes the first library again
    shutil.copytree(tmp_path, other)
    (other / "knee_bonded.c").write_text(text, "ascii")
    code, outputs, slopes = Compiled(other, "knee_bonded").gradients(made.present)
    assert code == 1
    assert np.isnan(outputs).all()
    assert np.isnan(slopes).all()


@recorded
@pytest.mark.skipif(shutil.which("g++") is None, reason="no C++ compiler")
def test_the_file_is_cpp_too(tmp_path):
    """Without a warning, under the oldest and a recent standard."""
    subject = ao.read(bench(("name: test bench", 'name: "*/ ??/ \\\\ µ"'))).subject()
    for name, content in design_files(subject, stem="40 µ", program="p", date=None).items():
        (tmp_path / name).write_bytes(content)
    for standard in ("c++98", "c++20"):
        command = [
            "g++",
            "-x",
            "c++",
            f"-std={standard}",
            *WARNINGS,
            "-fsyntax-only",
            "design_40.c",
        ]
        subprocess.run(command, cwd=tmp_path, check=True, capture_output=True, timeout=300)


@recorded
@compiled
def test_hostile_names_stay_texts(tmp_path):
    """Names of design, load case and file cannot end a comment or a string, nor add code."""
    design = tmp_path / "*40 é.yaml"
    text = bench(
        ("name: test bench", "name: '*/ #error ??/ \\'"), ("name: stance", "name: Stoß +1")
    )
    design.write_text(text, "utf-8")
    result = run("export", design, "--format", "c", "--out", tmp_path, "--json")
    names = [Path(file["path"]).name for file in result.json["files"]]
    assert names == ["design_40.h", "design_40.c"]
    made = Compiled(tmp_path, "design_40")
    assert "load_cases[Stoß +1].force" in [entry[0] for entry in made.inputs]
    assert made.values(made.present)[0] == 0


OWN = "import actuator_opt as ao\n@ao.metric('own')\ndef own(v): return 1.0\n"


@recorded
@pytest.mark.parametrize(
    ("design", "options", "message"),
    [
        ("aalto_40_25_220", (), "a C file needs variables, by which it computes gradients"),
        ("steel_baseline", ("--plugin", "own.py"), "custom metrics cannot be written as C"),
        ("steel", (), "did you mean"),
    ],
)
def test_designs_that_have_no_c_file(design, options, message, tmp_path, monkeypatch):
    """One line with the remedy, no file."""
    monkeypatch.chdir(tmp_path)
    Path("own.py").write_text(OWN, "utf-8")
    file = ROOT / f"designs/{design}.yaml"
    result = run("export", file, "--format", "c", *options, "--out", "out", "--json")
    (fault,) = result.errors
    assert result.code == 3
    assert message in fault["message"] + fault["remedy"]
    assert fault["remedy"]
    assert not Path("out").exists()


def test_without_the_machine_one_line_says_so(tmp_path, monkeypatch):
    """The program is written by the machine of the installation."""
    (tmp_path / "joint.yaml").write_text(bench(), "utf-8")
    monkeypatch.setattr(programs, "AVAILABLE", False)
    result = run("export", tmp_path / "joint.yaml", "--format", "c", "--out", tmp_path)
    assert result.code == 3
    assert "the machine was not built at installation" in result.err
    assert result.err.count("\n") == 1
    assert [path.name for path in tmp_path.iterdir()] == ["joint.yaml"]


def test_names_in_c_are_words():
    """Each name once, short, in ASCII."""
    assert constants("a", ["x", "x", "x_2", "x"]) == ["A_X", "A_X_2", "A_X_2_2", "A_X_3"]
    assert file_word("9") == "design_9"
    assert len(file_word(500 * "ab")) == 48
    assert quoted("a\nb") == '"a b"'
    assert remark("????") == "? ? ? ?"
    assert table("int", "T", []) == "static const int T[] = {\n0\n};\n"
    assert "NAN,-INFINITY" in table("double", "T", [float("nan"), -np.inf])


SCENARIOS = [
    ("servo_knee", "knee_step"),
    ("course_cylinder", "course_motor_position"),
    ("course_cylinder", "course_valve_ramp"),
]


@recorded
@compiled
@pytest.mark.parametrize(("design", "scenario"), SCENARIOS)
def test_the_equations_of_a_scenario(design, scenario, tmp_path):
    """Rates, Jacobian, signals and guards equal generated Python, at random states and flags."""
    paths = ROOT / f"designs/{design}.yaml", ROOT / f"designs/scenarios/{scenario}.yaml"
    result = run("export", paths[0], "--scenario", paths[1], "--format", "c", "--out", tmp_path)
    assert result.err.splitlines() == [f"wrote {tmp_path / scenario}.{x}" for x in "hc"]
    compare(tmp_path, scenario, ao.read_scenario(paths[1]))


def compare(folder, name, trial):
    """Compare the compiled file of a scenario with its expressions, as generated Python."""
    made = library(folder, name)
    actuator = plant(trial.actuator.subject())
    tuned = tune(trial.scenario, actuator, trial.records)
    gains = None if tuned is None else tuned.gains
    system = assemble(trial.scenario, actuator, trial.records, gains).system
    symbols, rates = [x.symbol for x in system.states], [x.rate for x in system.states]
    unpack = {", ".join(str(x.args[0]) for x in symbols) + ",": "y.tolist()"}
    unpack |= {", ".join(system.flags) + ",": "m"} if system.flags else {}
    entries = [x for row in jacobian(rates, symbols) for x in row]
    results = [x.value for x in system.signals] + [x.guard for x in system.switches]
    tables = [node for node in needed([*rates, *entries, *results]) if node.op == "table"]
    rng = np.random.default_rng(7)
    for _ in range(20):
        t = 2 * trial.scenario.duration * rng.random()
        y = np.array([x.initial + 1e4 * x.tolerance * rng.standard_normal() for x in system.states])
        m = tuple((rng.random(len(system.flags)) > 0.5).tolist())
        looked = [system.graph.tables[node.args[0]](t) for node in tables]
        inputs, work = np.array([t, *y, *m, *looked]), np.full(10_000, np.nan)
        for what, wanted in (("rates", rates), ("jacobian", entries), ("outputs", results)):
            expected = np.array(function("f", "t, y, m", unpack, wanted)(t, y, m), dtype=float)
            found = np.full(len(wanted), np.nan)
            getattr(made, f"{name}_{what}")(*map(pointer, (inputs, found, work)))
            scale = np.max(np.abs(expected)) if what == "jacobian" else np.abs(expected)
            assert np.isfinite(expected).all()
            assert np.all(np.abs(found - expected) <= 1e-12 * (scale + 1e-30)), what


@recorded
@compiled
def test_records_of_a_scenario_are_inputs(tmp_path):
    """Values of a recorded column, and its slope where the equations use it."""
    times = np.linspace(0.0, 1.0, 21)
    lines = ["time [s],reference [mm]", *(f"{t},{10 * np.sin(6 * t)}" for t in times)]
    (tmp_path / "course.csv").write_text("\n".join(lines), "utf-8")
    text = (ROOT / "designs/scenarios/knee_step.yaml").read_text("utf-8")
    design = ROOT / "designs/servo_knee.yaml"
    head = text[: text.index("control:")].replace("../servo_knee.yaml", str(design))
    file = tmp_path / "followed.yaml"
    parts = "[{shape: record, file: course.csv, column: reference}]"
    file.write_text(f"{head}control: {{position: {parts}}}\n", "utf-8")
    result = run("export", design, "--scenario", file, "--format", "c", "--out", tmp_path)
    assert result.code == 0, result.err
    assert "FOLLOWED_IN_REFERENCE_OF_COURSE_CSV" in (tmp_path / "followed.h").read_text("ascii")
    compare(tmp_path, "followed", ao.read_scenario(file))


@recorded
@pytest.mark.parametrize(
    ("scenario", "kind", "code", "message"),
    [
        ("knee_step", "step", 2, "the equations of a scenario have no STEP file"),
        ("none", "c", 3, "no such file"),
    ],
)
def test_scenarios_that_have_no_file(scenario, kind, code, message, tmp_path):
    """One line, no file."""
    design, file = ROOT / "designs/servo_knee.yaml", ROOT / f"designs/scenarios/{scenario}.yaml"
    out = tmp_path / "out"
    result = run("export", design, "--scenario", file, "--format", kind, "--out", out)
    assert result.code == code
    assert message in result.err
    assert result.err.count("\n") == 1
    assert not out.exists()
