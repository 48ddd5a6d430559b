"""The terminal: read arguments, call the library, print. No physics.

stdout carries data, stderr messages; ``--json`` prints one SI object, faults included. Heavy
modules are imported inside the commands that need them.
"""

from __future__ import annotations

import copy
import os
import re
import sys
from os.path import relpath
from pathlib import Path
from typing import Annotated, Any

import typer
from typer.exceptions import TyperException

from .. import run_store
from ..errors import EXIT_CODES, ActuatorError, Diagnostic, ExitCode, UsageError
from ..metrics import METRICS
from ..suggest import shown
from ..version import VERSION
from . import faults, materials, runs, streams
from .compare import compare
from .doctor import doctor
from .explore import explore
from .export import export
from .optimise import optimise, sensitivity
from .options import (
    REPORTS,
    Date,
    DesignFile,
    Json,
    Out,
    PluginFile,
    Quiet,
    Report,
    Seed,
    Set,
)
from .pareto import pareto
from .records import calibrate, identify
from .rerun import rerun
from .seal import seal
from .shared import (
    assignments,
    check_targets,
    leave_by,
    read_actuator,
    say_files,
    write_report,
)
from .simulate import simulate
from .sweep import sweep
from .uncertainty import uncertainty

app = typer.Typer(
    name="actuator-opt",
    help="Design optimisation of lightweight hydraulic actuators.",
    epilog=f"Exit codes: {', '.join(f'{int(x)} {words}' for x, words in EXIT_CODES.items())}.",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
    add_completion=False,
    context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 100},
)
app.add_typer(materials.app, name="materials")
app.add_typer(runs.app, name="runs")


@app.callback(invoke_without_command=True)
def _main(
    version: Annotated[bool, typer.Option("--version", help="Print the version.")] = False,
    debug: Annotated[
        bool,
        typer.Option(
            "--debug",
            help=f"Show tracebacks of faults of the program (or set {faults.DEBUG}=1).",
        ),
    ] = False,
) -> None:
    if version:
        streams.out(f"actuator-opt {VERSION}")
        raise typer.Exit


def _named_file(name: str) -> tuple[str, Path]:
    """Title and file that `init NAME` promises: ``"left knee"`` is written to left_knee.yaml."""
    folder, base = os.path.split(name)
    title = base.removesuffix(".yaml").removesuffix(".yml")
    if base and not title.strip(". "):
        raise UsageError(Diagnostic(f"NAME: {shown(name)} names no file", "write e.g. left_knee"))
    stem = re.sub(r"[^\w.+-]+", "_", title).strip("_.")
    return title, Path(folder, f"{stem or 'actuator'}.yaml")


@app.command()
def init(
    name: Annotated[
        str | None,
        typer.Argument(
            metavar="NAME",
            help="Name of the actuator or scenario; NAME.yaml is written. "
            "Without a name the text is printed.",
        ),
    ] = None,
    source: Annotated[
        str | None, typer.Option("--from", metavar="DESIGN", help="Start from this design.")
    ] = None,
    scenario: Annotated[
        str | None,
        typer.Option("--scenario", metavar="DESIGN", help="A scenario around this design instead."),
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option("--out", metavar="FILE", help="Another file to write; - prints the text."),
    ] = None,
    as_json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Write a commented start file for a design or a scenario."""
    from ..design import read_design
    from ..design.kinds import ValueFault
    from ..design.scenario.template import scenario_text
    from ..design.template import init_text
    from ..store import require_writable, write_text

    if scenario is not None and source is not None:
        raise UsageError(Diagnostic("--from and --scenario", "give one of them"))
    given = {}
    if name is not None:
        given["name"], file = _named_file(name)
        out = file if out is None else out
    if out is not None and str(out) == "-":
        out = None
    try:
        if scenario is None:
            text = init_text(from_design=None if source is None else read_design(source), **given)
        else:
            beside = relpath(scenario, Path() if out is None else out.parent)
            text = scenario_text(read_design(scenario).design, beside, **given)
    except ValueFault as fault:
        raise UsageError(Diagnostic(f"NAME: {fault.message}", fault.remedy)) from None
    if out is not None:
        if os.path.lexists(out):
            raise UsageError(Diagnostic("exists already", "choose another name", str(out)))
        require_writable(out)
        write_text(out, text)
    if as_json:
        streams.out_json({"text": text} if out is None else {"files": [{"path": str(out)}]})
    elif out is None:
        streams.out(text, end="")
    elif not quiet:
        streams.err(f"wrote {out}")


@app.command()
def check(
    designs: Annotated[
        list[str],
        typer.Argument(metavar="FILE", help="Design or scenario files; - for stdin."),
    ],
    sets: Set = None,
    plugin: PluginFile = None,
    as_json: Json = False,
    quiet: Quiet = False,
    out: Annotated[Path, typer.Option("--out", hidden=True)] = REPORTS,
    seed: Annotated[int, typer.Option("--seed", hidden=True)] = 0,
) -> None:
    """Name every fault of design and scenario files."""
    from .. import verbs

    pairs = assignments(sets)
    faults: list[Diagnostic] = []
    warnings: list[dict[str, str]] = []
    for design in designs:
        found = verbs.examine(design, set=pairs, plugins=plugin or [])
        faults += found.faults
        warnings += [{"file": design, "message": text} for text in found.warnings]
        if quiet or as_json:
            continue
        for text in found.warnings:
            streams.err(f"{design}: warning: {text}")
        if not found.faults:
            streams.err(f"{design}: no faults")
    if as_json:
        errors = {"errors": [fault.to_dict() for fault in faults]}
        streams.out_json(errors | ({"warnings": warnings} if warnings else {}))
    else:
        for fault in faults:
            streams.err(str(fault))
    if faults:
        raise typer.Exit(ExitCode.BAD_INPUT)


@app.command()
def evaluate(
    design: DesignFile,
    sets: Set = None,
    plugin: PluginFile = None,
    report: Report = False,
    out: Out = REPORTS,
    date: Date = None,
    seed: Seed = 0,
    as_json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Every metric, requirement and check of a design as it stands."""
    from .. import verbs

    if report:
        check_targets(out, date)
    actuator = read_actuator(design, sets, plugin)
    evaluation = verbs.evaluate(actuator)
    if report:
        evaluation = verbs.with_yield(evaluation, plugins=actuator.plugins, seed=seed)
    files = write_report(evaluation, actuator, out, date) if report else []
    if as_json:
        streams.out_json(evaluation.to_dict() | ({"files": files} if files else {}))
    elif not quiet:
        from ..reporting.terminal import evaluation_text

        streams.out(evaluation_text(evaluation, **streams.style()), end="")
        say_files(files)
    leave_by(evaluation)


app.command()(optimise)
app.command("optimize", hidden=True)(optimise)
app.command()(sensitivity)
app.command()(uncertainty)
app.command()(compare)
app.command()(sweep)
app.command()(explore)
app.command()(pareto)
app.command()(seal)
app.command()(simulate)
app.command()(identify)
app.command()(calibrate)


@app.command()
def report(
    design: Annotated[
        str,
        typer.Argument(metavar="DESIGN", help="Design file, - for stdin, or a run (id, last)."),
    ],
    sets: Set = None,
    out: Out = REPORTS,
    date: Date = None,
    seed: Seed = 0,
    plugin: PluginFile = None,
    as_json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Write the report of a design as it is, or of a run."""
    from .. import verbs

    check_targets(out, date)
    if run_store.is_name(design):
        files, code = runs.reported(design, sets, plugin, out, date)
    else:
        actuator = read_actuator(design, sets, plugin)
        evaluation = verbs.evaluate(actuator)
        evaluation = verbs.with_yield(evaluation, plugins=actuator.plugins, seed=seed)
        files = write_report(evaluation, actuator, out, date)
        code = ExitCode.MET if evaluation.met else ExitCode.MISSED
    if as_json:
        streams.out_json({"files": files})
    elif not quiet:
        say_files(files)
    sys.exit(code)  # an Exit with the status of an interrupt would be told as one


app.command()(rerun)
app.command()(export)


@app.command()
def schema(
    scenario: Annotated[
        bool, typer.Option("--scenario", help="Of scenario files, not of designs.")
    ] = False,
    as_json: Annotated[bool, typer.Option("--json", help="As always: it is JSON.")] = False,
) -> None:
    """Print the JSON Schema of design or scenario files."""
    from ..design.materials import load_library
    from ..design.schema import json_schema
    from ..quantities import RESULTS

    if scenario:
        from ..design.scenario import Scenario

        streams.out_json(json_schema(Scenario, materials=load_library(), metrics=RESULTS))
    else:
        streams.out_json(json_schema(materials=load_library(), metrics=METRICS))


app.command()(doctor)


def _misunderstood(error: TyperException) -> ExitCode:
    """Say what the command line lacks; without arguments, the help."""
    context = getattr(error, "ctx", None)
    message = error.format_message()
    if message.startswith("Usage:"):
        streams.err(message)
        return ExitCode.USAGE
    remedy = "" if context is None else f"see: {context.command_path} --help"
    fault = Diagnostic(" ".join(message.split()).removesuffix("."), remedy)
    return streams.faults([fault], ExitCode.USAGE)


def _command() -> Any:
    """The command line, in which every command takes ``--debug``."""
    root: Any = typer.main.get_command(app)
    debug = copy.copy(next(option for option in root.params if option.name == "debug"))
    debug.expose_value = False
    commands = list(root.commands.values())
    for command in commands:
        commands += getattr(command, "commands", {}).values()
        command.params.append(debug)
    return root


def _answered() -> int:
    """Run the command line; its exit code, and faults of the input as lines."""
    try:
        code: int = _command()(prog_name="actuator-opt", standalone_mode=False) or ExitCode.MET
        if code == ExitCode.INTERRUPTED:  # what typer makes of Ctrl-C
            raise KeyboardInterrupt
    except ActuatorError as error:
        code = streams.faults(error.diagnostics, error.exit_code)
    except TyperException as error:
        code = _misunderstood(error)
    except SystemExit as leaving:
        code = leaving.code if isinstance(leaving.code, int) else ExitCode.FAULT
        if code == ExitCode.INTERRUPTED:  # the command has said so
            return code
    if streams.interrupted():  # heard, and lost on the way here
        raise KeyboardInterrupt
    return code


def main() -> None:
    """Run the command line; every fault leaves as a line and an exit code, never a traceback."""
    streams.prepare()
    try:
        code = _answered()
    except KeyboardInterrupt:
        code = streams.faults([Diagnostic("interrupted")], ExitCode.INTERRUPTED)
    except Exception as error:
        if streams.interrupted():  # it broke what ran
            code = streams.faults([Diagnostic("interrupted")], ExitCode.INTERRUPTED)
        else:
            code = streams.faults(*faults.unexpected(error))
    sys.exit(code)
