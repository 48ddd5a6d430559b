"""What the commands share: reading a design, checking where to write, saying what was written."""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

from ..errors import ActuatorError, Diagnostic, ExitCode, UsageError
from . import streams

if TYPE_CHECKING:
    from ..evaluation import Evaluation
    from ..optimisation.result import Optimisation
    from ..quantities import Quantity
    from ..reporting import ExtraTable
    from ..verbs import Actuator


def assignments(sets: list[str] | None) -> list[tuple[str, str]]:
    """The ``--set`` of a command, each as PATH and value."""
    from ..design import split_assignment

    return [split_assignment(text) for text in sets or []]


def read_actuator(design: str, sets: list[str] | None, plugins: list[Path] | None) -> Actuator:
    """The design of a command, with its ``--set`` and ``--plugin``."""
    from ..verbs import read

    return read(design, set=assignments(sets), plugins=plugins or [])


def given(option: str, text: str | None, quantity: Quantity) -> float | None:
    """The SI number of an option in its quantity's unit."""
    from ..design.kinds import ValueFault, read_quantity

    if text is None:
        return None
    try:
        return read_quantity(text, quantity)
    except ValueFault as fault:
        raise UsageError(Diagnostic(f"{option}: {fault.message}", fault.remedy)) from None


def leave_by(evaluation: Evaluation) -> None:
    """Leave with the exit code of a missed requirement, where one is."""
    if not evaluation.met:
        raise typer.Exit(ExitCode.MISSED)


_TARGETS = ("--out", "--write", "--csv", "--parquet")
"""Options that say where to write."""


def command_line() -> str:
    """The command line without what does not change the result: same input, same bytes."""
    import shlex

    words, kept, skip = sys.argv[1:], [], False
    for word in words:
        if skip:
            skip = False
        elif word in _TARGETS:
            skip = True
        elif word not in (
            "--json",
            "--report",
            "--quiet",
            "-q",
            "--no-record",
            "--debug",
        ) and not word.startswith(tuple(f"{one}=" for one in _TARGETS)):
            kept.append(word)
    return shlex.join(["actuator-opt", *kept])


def check_targets(out: Path | None, date: str | None, write: Path | None = None) -> None:
    """Refuse a date or a place to write that cannot be, before the work."""
    from .. import store
    from ..verbs import date_from_environment

    if write is not None:
        store.require_writable(write)
    if out is not None:
        store.require_folder(out)
        _check_date(date)
        date_from_environment()


def write_report(
    subject: Evaluation | Optimisation,
    actuator: Actuator,
    out: Path,
    date: str | None,
    tables: Sequence[ExtraTable] = (),
) -> list[dict[str, Any]]:
    """Write the report; its files as JSON."""
    from ..verbs import report

    files = report(
        subject, folder=out, actuator=actuator, command=command_line(), date=date,
        extra_tables=tables,
    )  # fmt: skip
    return [file.to_dict() for file in files]


def keep_record(make: Callable[[], object]) -> None:
    """Record a run; where that fails, one line says so and nothing else is lost."""
    try:
        make()
    except ActuatorError as error:
        remedy = "set ACTUATOR_OPT_RUNS to another folder, or give --no-record"
        fault = replace(error.diagnostics[0], remedy=remedy)
        streams.err(f"the run is not recorded: {fault}")


def _check_date(date: str | None) -> None:
    from ..verbs import is_date

    if date is not None and not is_date(date):
        raise UsageError(Diagnostic(f'--date "{date}" is no date', "write YYYY-MM-DD"))


def say_files(files: list[dict[str, Any]]) -> None:
    """Name every written file."""
    for file in files:
        streams.err(f"wrote {file['path']}")


def named_columns(texts: list[str] | None) -> dict[str, str]:
    """Channel and column of every ``--column``."""
    found: dict[str, str] = {}
    for text in texts or []:
        channel, equals, name = text.partition("=")
        if not equals or not channel.strip() or not name.strip():
            message = f'--column "{text}" is no CHANNEL=NAME'
            raise UsageError(Diagnostic(message, 'write e.g. "p1=Channel 3 [bar]"'))
        found[channel.strip()] = name.strip()
    return found


def file_of_units(units: str | None) -> list[str]:
    """The file of a ``--units``, where it names one."""
    from ..identification.column_units import SI

    return [] if units in (None, SI) else [str(units)]
