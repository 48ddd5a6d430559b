"""The command line: its commands, and how every one of them ends.

stdout carries data, stderr messages; ``--json`` prints one SI object, faults included. Only the
module of the command asked for is imported, and heavy modules inside the command that needs them.
"""

from __future__ import annotations

import copy
import sys
from collections.abc import Sequence
from importlib import import_module
from typing import Annotated, Any

import typer
from typer.exceptions import TyperException

from ..base.errors import EXIT_CODES, ActuatorError, Diagnostic, ExitCode
from ..version import VERSION
from . import faults, streams

COMMANDS = {
    "init": "design",
    "check": "design",
    "evaluate": "design",
    "optimise": "optimise",
    "optimize": "optimise",
    "sensitivity": "optimise",
    "uncertainty": "studies",
    "compare": "design",
    "sweep": "sweep",
    "explore": "sweep",
    "pareto": "optimise",
    "seal": "studies",
    "simulate": "studies",
    "identify": "records",
    "calibrate": "records",
    "report": "design",
    "rerun": "runs",
    "export": "design",
    "schema": "design",
    "doctor": "doctor",
    "materials": "materials",
    "runs": "runs",
}
"""Every command, in the order of the help, with the module whose function of that name it is."""

HIDDEN = {"optimize"}
"""Other spellings, which the help leaves out."""


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


def _leave(code: ExitCode | None, **options: object) -> None:
    """End by the exit code that a command returns; an interrupted one has said so itself."""
    sys.exit(code or ExitCode.MET)


def command_line(arguments: Sequence[str] = ()) -> Any:
    """The command line, in which every command takes ``--debug``.

    Where the first argument names a command, only that one is there: the others cost time.
    """
    app = typer.Typer(
        name="actuator-opt",
        help="Design optimisation of lightweight hydraulic actuators.",
        epilog=f"Exit codes: {', '.join(f'{int(x)} {words}' for x, words in EXIT_CODES.items())}.",
        no_args_is_help=True,
        pretty_exceptions_enable=False,
        rich_markup_mode=None,
        add_completion=False,
        context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 100},
        invoke_without_command=True,
        callback=_main,
        result_callback=_leave,
    )
    asked = [name for name in COMMANDS if name in arguments[:1]]
    for name in asked or ([] if list(arguments) == ["--version"] else COMMANDS):
        found = getattr(import_module(f".{COMMANDS[name]}", __package__), name)
        if isinstance(found, typer.Typer):
            app.add_typer(found, name=name)
        else:
            app.command(name, hidden=name in HIDDEN)(found)
    root: Any = typer.main.get_command(app)
    debug = copy.copy(next(option for option in root.params if option.name == "debug"))
    debug.expose_value = False
    commands = list(root.commands.values())
    for command in commands:
        commands += getattr(command, "commands", {}).values()
        command.params.append(debug)
    return root


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


def _answered() -> int:
    """Run the command line; its exit code, and faults of the input as lines."""
    try:
        command = command_line(sys.argv[1:])
        code: int = command(prog_name="actuator-opt", standalone_mode=False) or ExitCode.MET
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
