"""One declaration for each type of result: terminal and library write the same bytes."""

from __future__ import annotations

import ast
import shlex
from importlib import import_module
from pathlib import Path

import pytest
from cases.digests import digests
from cases.one_line import one_line
from cli_runner import BENCH, DESIGNS, run

import actuator_opt as ao
from actuator_opt import api as verbs, cli
from actuator_opt.api import results
from actuator_opt.base.errors import ExitCode, UsageError
from actuator_opt.base.tables import OneLine
from actuator_opt.cli.app import COMMANDS, HIDDEN

DATE = "2026-03-04"
SCENARIO = Path("step.yaml")
RECORD = DESIGNS / "records" / "knee_bench.csv"
KNEE = DESIGNS / "knee_bonded.yaml"
STEP = f"""
name: step
design: {DESIGNS / "servo_knee.yaml"}
duration: 0.3 s
sample_time: 1 ms
initial: {{position: 45 mm}}
load:
  force:
    - {{shape: constant, value: 2 kN}}
control:
  position:
    - {{shape: step, value: 10 mm, start: 0.1 s}}
requirements:
  overshoot: {{max: 5 %}}
  peak_pressure: {{max: 315 bar}}
"""
PIECES = ("text", "report", "csv", "record", "data")
FRONT = ["mass:min", "stiffness_min:max"]


@pytest.fixture(autouse=True)
def place(tmp_path, monkeypatch):
    """A folder with the bench design and a record of its own; runs go there too."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("ACTUATOR_OPT_RUNS", str(tmp_path / "runs"))
    monkeypatch.delenv("SOURCE_DATE_EPOCH", raising=False)
    Path("bench.yaml").write_text(BENCH)
    Path("step.yaml").write_text(STEP, encoding="utf-8")
    rows = "".join(f"{k / 1000:g},{45 + k / 200:g}\n" for k in range(1000))
    Path("record.csv").write_text(f"t [s],x [mm]\n{rows}")


@pytest.mark.parametrize("kind", results.KINDS.values(), ids=results.KINDS)
def test_every_piece_of_a_kind_is_there(kind):
    """The type and all functions of a kind exist under the names that are declared."""
    module, _, name = kind.type.partition(":")
    cls = getattr(import_module(f"actuator_opt.{module}"), name)
    assert (cls.__module__, cls.__qualname__) == (f"actuator_opt.{module}", name)
    for piece in PIECES:
        declared = getattr(kind, piece)
        if declared is not None:
            module, _, name = declared.rpartition(":")
            home = import_module(f"actuator_opt.{module}") if module else cls
            assert callable(getattr(home, name)), (kind.type, piece)


def test_a_kind_that_is_doubled_or_incomplete_is_refused():
    """Both fail where they are declared, which is at import."""
    kind = results.KINDS["uncertainties.result:Uncertainty"]
    with pytest.raises(TypeError, match="twice"):
        results.kinds(kind, kind)
    with pytest.raises(TypeError, match="csv"):
        results.ResultKind(kind.type, kind.exit_code, text=None, report=None, record=None)


def test_every_writer_of_the_library_belongs_to_a_kind():
    """What writes a report or a CSV is declared; a page of several simulations is no result."""
    declared = {
        name.rpartition(":")[2]
        for kind in results.KINDS.values()
        for name in (kind.report, kind.csv)
        if name is not None
    }
    writers = {name for name in ao.__all__ if name.startswith("write_")}
    assert writers - declared == {"write_comparison"}


# Each case: the words of the terminal, and the library's call with the same inputs. What follows
# in the call is where to, the date and the command.


def _evaluation(**paper):
    return ao.report(ao.read("bench.yaml"), seed=3, **paper)


def _optimisation(**paper):
    actuator = ao.read(DESIGNS / "servo_knee.yaml")
    best = ao.optimise(actuator, starts=1)
    timed = ao.verify_dynamics(SCENARIO, best.best)
    return ao.report(best, actuator=actuator, dynamics_verified=timed, **paper)


def _prices(**paper):
    actuator = ao.read("bench.yaml")
    return ao.report(verbs.Prices(ao.optimise(actuator)), actuator=actuator, **paper)


def _front(**paper):
    actuator = ao.read("bench.yaml")
    front = ao.pareto(actuator, FRONT, n=4, checks=0)
    return ao.report(front, actuator=actuator, **paper)


def _uncertainty(**paper):
    actuator = ao.read("bench.yaml")
    study = ao.uncertainty(actuator, count=100, rows=8)
    return ao.report(study, actuator=actuator, **paper)


def _comparison(folder, **_):
    return ao.report(ao.compare("bench.yaml", KNEE), folder=folder)


def _seal(**paper):
    actuator = ao.read("bench.yaml")
    study = ao.seal(actuator, place="rod", curves=True, mapped=True)
    return ao.report(study, actuator=actuator, **paper)


def _simulation(**paper):
    trial = ao.read_scenario(SCENARIO)
    ranked = ao.servo_sensitivities(trial)
    return ao.report(ao.simulate(trial), scenario=trial, sensitivities=ranked, **paper)


def _compared(**paper):
    trial = ao.read_scenario(SCENARIO)
    return ao.report(ao.compare_measured(trial, "record.csv"), scenario=trial, **paper)


def _identification(**paper):
    actuator = ao.read(KNEE)
    return ao.report(ao.identify(RECORD, design=actuator), actuator=actuator, **paper)


def _calibrated(**paper):
    return ao.report(ao.calibrate(RECORD, design=KNEE, search=False), **paper)


def _kept_sweep(folder, **_):
    restored = ao.restore("last")
    return ao.report(restored.result, folder=folder)


def _run(folder, date, **_):
    return ao.report("last", folder=folder, date=date)


def _restored(folder, date, **_):
    return ao.report(ao.restore(ao.read_run("last")), folder=folder, date=date)


def _rerun(folder, **_):
    return ao.report(ao.rerun("before/bench.pdf"), folder=folder)


PARETO = ["pareto", "bench.yaml", "-n", "4", "--checks", "0"]
PARETO += [word for one in FRONT for word in ("--objective", one)]
SWEEP = ["sweep", "bench.yaml", "--vary", "retention.wall=3mm..4mm:3", "--store", "rows.db"]
CASES = {
    "Evaluation": (_evaluation, ["report", "bench.yaml", "--seed", "3"]),
    "Optimisation": (
        _optimisation,
        ["optimise", DESIGNS / "servo_knee.yaml", "--starts", "1", "--verify-dynamics", SCENARIO],
    ),
    "Prices": (_prices, ["sensitivity", "bench.yaml", "--report"]),
    "ParetoFront": (_front, [*PARETO, "--report"]),
    "Uncertainty": (
        _uncertainty,
        ["uncertainty", "bench.yaml", "-n", "100", "--index-rows", "8", "--report"],
    ),
    "Comparison": (_comparison, ["compare", "bench.yaml", KNEE]),
    "SealStudy": (_seal, ["seal", "bench.yaml", "--seal", "rod", "--map", "--report"]),
    "Simulation": (_simulation, ["simulate", SCENARIO, "--sensitivity", "--report"]),
    "Compared": (_compared, ["simulate", SCENARIO, "--measured", "record.csv", "--report"]),
    "Identification": (_identification, ["identify", RECORD, "--design", KNEE, "--report"]),
    "Calibrated": (
        _calibrated,
        ["calibrate", RECORD, "--design", KNEE, "--no-optimise", "--report"],
    ),
    "KeptSweep": (_kept_sweep, ["report", "last"]),
    "Run": (_run, ["report", "last"]),
    "Restored": (_restored, ["report", "last"]),
    "Rerun": (_rerun, ["rerun", "before/bench.pdf"]),
}
BEFORE = {
    "KeptSweep": SWEEP,
    "Run": ["optimise", "bench.yaml", "--starts", "1", "--json"],
    "Restored": [*PARETO, "--report", "--out", "before"],
    "Rerun": ["evaluate", "bench.yaml", "--report", "--out", "before", "--date", DATE],
}
UNDATED = ("Comparison", "Rerun")


def _ended(result):
    assert result.code in (ExitCode.MET, ExitCode.MISSED), result.err


def _reported():
    """Names of the kinds that have a report; those that take longest are marked."""
    for kind in results.KINDS.values():
        name = kind.type.rpartition(":")[2]
        if kind.report:
            slow = name in (
                "Optimisation",
                "Simulation",
                "Rerun",
                "Calibrated",
                "Prices",
                "Identification",
                "Run",
            )
            yield pytest.param(name, marks=[pytest.mark.long] if slow else [])


@pytest.mark.parametrize("name", [*_reported()])
def test_the_terminal_and_the_library_write_the_same_bytes(name, monkeypatch):
    """Every kind with a report has a case; only the command is the library's to state."""
    call, words = CASES[name]
    whole = results.report

    def shown(subject, **more):
        for one in (subject, *more.values()):
            if isinstance(one, OneLine):
                one_line(one)
        return whole(subject, **more)

    monkeypatch.setattr(results, "report", shown)
    if name in BEFORE:
        _ended(run(*BEFORE[name], "-q"))
    dated = [] if name in UNDATED else ["--date", DATE]
    _ended(run(*words, *dated, "--out", "terminal", "-q"))
    command = ["actuator-opt", *(str(word) for word in [*words, *dated] if word != "--report")]
    files = call(folder="library", date=DATE, command=shlex.join(command))
    assert {file.path.name for file in files} == set(digests("library"))
    assert digests("library") == digests("terminal")


def test_what_a_report_needs_is_asked_for_in_one_line():
    """No traceback of something far below: what is missing, and what to give."""
    actuator = ao.read("bench.yaml")
    study = ao.uncertainty(actuator, count=20, rows=0)
    with pytest.raises(UsageError, match="give actuator"):
        ao.report(study)
    with pytest.raises(UsageError, match="give scenario"):
        ao.report(ao.simulate(SCENARIO))
    with pytest.raises(UsageError, match="BendingResult has no report"):
        ao.report(object.__new__(ao.BendingResult))
    with pytest.raises(UsageError, match='date "today" is not a date'):
        ao.report(actuator, date="today")
    with pytest.raises(UsageError, match="float is not a result"):
        ao.report(1.0)


def _is_plain(function: ast.FunctionDef) -> bool:
    """Whether a function is decorated at most with the options that commands share."""
    return [ast.unparse(x) for x in function.decorator_list] in ([], ["with_common_options"])


def test_every_command_is_registered():
    """The public functions of the modules of `cli` are commands, but for those that all share."""
    shared = {"__init__", "app", "browser", "completion", "faults", "job", "options", "streams"}
    known = {("materials", "materials"), ("runs", "runs")}
    for file in Path(cli.__file__).parent.glob("*.py"):
        own = [] if file.stem in shared else ast.parse(file.read_text("utf-8")).body
        plain = (x for x in own if isinstance(x, ast.FunctionDef) and _is_plain(x))
        known |= {(x.name, file.stem) for x in plain if not x.name.startswith("_")}
    named = {name: home.partition(".") for name, home in COMMANDS.items() if name not in HIDDEN}
    assert known == {(function or name, module) for name, (module, _, function) in named.items()}


def test_only_the_command_asked_for_is_there():
    """The help, and what nobody knows, see all commands in the order of the table."""
    assert set(cli.command_line(["check", "bench.yaml"]).commands) == {"check"}
    assert set(cli.command_line(["runs", "list"]).commands) == {"runs"}
    for arguments in ([], ["--help"], ["chekc"], ["--debug", "check"]):
        assert set(cli.command_line(arguments).commands) == set(COMMANDS)
    listed = run("--help").out
    for name in COMMANDS:
        assert (f"\n  {name} " in listed) == (name not in HIDDEN), name
