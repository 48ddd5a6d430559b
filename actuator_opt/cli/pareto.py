"""The command `pareto`: what can be had of several objectives at once."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from ..bounds import CHECKS
from ..errors import ExitCode
from ..store import require_apart
from . import streams
from .options import (
    REPORTS,
    Date,
    DesignFile,
    Json,
    NoRecord,
    Out,
    PluginFile,
    Quiet,
    Report,
    Seed,
    Set,
)
from .shared import check_targets, command_line, keep_record, read_actuator, say_files

if TYPE_CHECKING:
    from ..optimisation.pareto_result import ParetoFront
    from ..verbs import Actuator


def pareto(
    design: DesignFile,
    objectives: Annotated[
        list[str] | None,
        typer.Option(
            "--objective", metavar="METRIC:min|max", help='Twice to four times, e.g. "mass:min".'
        ),
    ] = None,
    n: Annotated[int, typer.Option("-n", metavar="N", help="Designs of the front.")] = 50,
    checks: Annotated[
        int,
        typer.Option(
            "--checks",
            min=CHECKS.least,
            max=CHECKS.most,
            metavar="N",
            help="Full searches for what is merely local.",
        ),
    ] = 3,
    csv: Annotated[
        Path | None, typer.Option("--csv", metavar="FILE", help="Save the designs of the front.")
    ] = None,
    sets: Set = None,
    plugin: PluginFile = None,
    report: Report = False,
    out: Out = REPORTS,
    date: Date = None,
    seed: Seed = 0,
    no_record: NoRecord = False,
    as_json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Trade two to four objectives: the Pareto front and its knee."""
    from .. import verbs

    check_targets(out if report else None, date, csv)
    if csv is not None:
        require_apart(csv, design)
    actuator = read_actuator(design, sets, plugin)
    with streams.watching():
        found = verbs.pareto(actuator, objectives or [], n=n, seed=seed, checks=checks)
    files = []
    if csv is not None and found.points:
        files.append(verbs.write_front_csv(found, csv).to_dict())
    if report and found.points:
        files += [
            file.to_dict()
            for file in verbs.write_front(
                found, folder=out, actuator=actuator, command=command_line(), date=date
            )
        ]
    if as_json:
        streams.out_json(found.to_dict() | ({"files": files} if files else {}))
    elif not quiet:
        from ..reporting.pareto_rows import front_text

        streams.out(front_text(found, **streams.style()), end="")
        say_files(files)
    if not no_record:
        recorded(found, actuator, command_line(), date)
    raise typer.Exit(outcome_of(found))


def recorded(found: ParetoFront, actuator: Actuator, command: str, date: str | None) -> None:
    """Keep a record of the front; where that fails, one line says so."""
    from ..verbs import record_front

    keep_record(lambda: record_front(found, actuator=actuator, command=command, date=date))


def outcome_of(found: ParetoFront) -> ExitCode:
    """The exit status of a front."""
    if found.status == "unsolved":
        return ExitCode.SOLVER_FAILED
    return ExitCode.MET if found.points else ExitCode.MISSED
