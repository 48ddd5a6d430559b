"""The command line: its commands and their exit codes.

Data are printed to stdout and messages to stderr; ``--json`` prints one object in SI, also for
faults. Only the module of the given command is imported, and heavy modules only inside the commands
that need them.
"""

from __future__ import annotations

import copy
import gc
import os
import sys
from collections.abc import Sequence
from importlib import import_module
from typing import Annotated, Any

import typer
from typer.exceptions import TyperException

from ..base.errors import EXIT_CODES, ActuatorError, Diagnostic, ExitCode
from ..base.words import nearest
from ..version import VERSION
from . import completion, streams

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
    "studio": "studio",
    "seal": "studies",
    "simulate": "studies",
    "identify": "records",
    "calibrate": "records",
    "report": "design",
    "rerun": "runs",
    "export": "design",
    "schema": "design",
    "explain": "reference",
    "list": "reference.list_names",
    "docs": "docs",
    "doctor": "runs",
    "materials": "materials",
    "runs": "runs",
}
"""All commands in the order of the help, each with its module, and its function if this has another
name."""

HIDDEN = {"optimize"}
"""Alternative spellings of commands, which the help does not list."""

PATIENCE = 100_000
"""Number of new objects after which Python searches for unused reference cycles (default: 700).

Imports make many lasting objects. With the default, searching them again and again takes a sixth of
the time of a short command.
"""


def _main(
    version: Annotated[bool, typer.Option("--version", help="Print the version.")] = False,
    debug: Annotated[
        bool,
        typer.Option(
            "--debug",
            help=f"Show tracebacks of internal errors (or set {streams.DEBUG}=1).",
        ),
    ] = False,
) -> None:
    if version:
        streams.out(f"actuator-opt {VERSION}")
        raise typer.Exit


def _leave(code: ExitCode | None, **options: object) -> None:
    """Exit with the code of a command."""
    sys.exit(code or ExitCode.MET)


def command_line(arguments: Sequence[str] = ()) -> Any:
    """Build the command line, with the option ``--debug`` for every command.

    If the first argument names a command, only this command is imported, to save time. The same
    holds for the line of which a shell asks for words.
    """
    app = typer.Typer(
        name="actuator-opt",
        help="Design optimisation of lightweight hydraulic actuators.",
        epilog=f"Exit codes: {', '.join(f'{int(x)} {words}' for x, words in EXIT_CODES.items())}.",
        no_args_is_help=True,
        pretty_exceptions_enable=False,
        rich_markup_mode=None,
        context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 100},
        invoke_without_command=True,
        callback=_main,
        result_callback=_leave,
    )
    first = arguments[:1] or completion.typed()
    names = [name for name in COMMANDS if name in first]
    for name in names or ([] if list(arguments) == ["--version"] else COMMANDS):
        module, _, other = COMMANDS[name].partition(".")
        function = getattr(import_module(f".{module}", __package__), other or name)
        if isinstance(function, typer.Typer):
            app.add_typer(function, name=name)
        else:
            app.command(name, hidden=name in HIDDEN)(function)
    root: Any = typer.main.get_command(app)
    debug = copy.copy(next(option for option in root.params if option.name == "debug"))
    debug.expose_value = False
    commands = list(root.commands.values())
    for command in commands:
        commands += getattr(command, "commands", {}).values()
        command.params.append(debug)
    return root


def _misunderstood(error: TyperException) -> ExitCode:
    """Report a misused command line; without arguments, print the help."""
    # typer raises its help as an error whose message starts with "Usage:"
    context = getattr(error, "ctx", None)
    message = error.format_message()
    if message.startswith("Usage:"):
        streams.err(message)
        return ExitCode.USAGE
    remedy = "" if context is None else f"see: {context.command_path} --help"
    unknown = getattr(error, "option_name", None)
    if unknown is not None and context is not None and "(Possible" in message:
        message = message.partition(" (Possible")[0]
        options = [name for option in context.command.params for name in option.opts]
        if near := nearest(unknown, options, 1):
            remedy = f"did you mean {near[0]}? {remedy}"
    fault = Diagnostic(" ".join(message.split()).removesuffix("."), remedy)
    return streams.faults([fault], ExitCode.USAGE)


def _exit_code() -> int:
    """Run the command line, print input faults as lines, and return the exit code."""
    try:
        command = command_line(sys.argv[1:])
        code: int = command(prog_name="actuator-opt", standalone_mode=False) or ExitCode.MET
        if code == ExitCode.INTERRUPTED:  # typer reports Ctrl-C in this way
            raise KeyboardInterrupt
    except ActuatorError as error:
        code = streams.faults(error.diagnostics, error.exit_code)
    except TyperException as error:
        code = _misunderstood(error)
    except SystemExit as leaving:
        code = leaving.code if isinstance(leaving.code, int) else ExitCode.FAULT
        if code == ExitCode.INTERRUPTED:  # already reported by the command
            return code
    if streams.interrupted():  # Ctrl-C was noticed, but the exception was lost
        raise KeyboardInterrupt
    return code


def main() -> None:
    """Run the command line; every fault gives a one-line message and an exit code, no traceback."""
    gc.set_threshold(PATIENCE)
    os.environ.setdefault("PYDANTIC_DISABLE_PLUGINS", "1")  # else each start lists all packages
    streams.prepare()
    try:
        code = _exit_code()
    except KeyboardInterrupt:
        code = streams.faults([Diagnostic("interrupted")], ExitCode.INTERRUPTED)
    except Exception as error:
        if streams.interrupted():  # the interruption caused the exception
            code = streams.faults([Diagnostic("interrupted")], ExitCode.INTERRUPTED)
        else:
            code = streams.faults(*streams.unexpected(error))
    gc.freeze()  # the end of the process frees all memory: Python need not sort it first
    sys.exit(code)
