"""The command `actuator-opt seal`: one seal looked at closely."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from ..errors import Diagnostic, ExitCode, UsageError
from ..quantities import INPUTS
from . import streams
from .options import REPORTS, Date, DesignFile, Json, Out, PluginFile, Quiet, Report, Seed, Set
from .shared import check_targets, command_line, given, read_actuator, say_files


def seal(
    design: DesignFile,
    place: Annotated[
        str, typer.Option("--seal", metavar="piston|rod", help="The seal to look at.")
    ],
    speed: Annotated[
        str | None,
        typer.Option(
            "--speed", metavar="V", help='Sliding speed, e.g. "0.1 m/s"; default: of a case.'
        ),
    ] = None,
    pressure: Annotated[
        str | None,
        typer.Option(
            "--pressure", metavar="P", help='Sealed pressure, e.g. "60 bar"; default: highest.'
        ),
    ] = None,
    mapped: Annotated[
        bool, typer.Option("--map", help="Also fill a map over speed and pressure (and its CSV).")
    ] = False,
    finite_elements: Annotated[
        bool,
        typer.Option(
            "--finite-elements",
            help="Compute the contact of an O-ring or step ring (extra fem; some seconds).",
        ),
    ] = False,
    write: Annotated[
        Path | None,
        typer.Option(
            "--write", metavar="FILE", help="Save the design with the contact profiles used."
        ),
    ] = None,
    sets: Set = None,
    plugin: PluginFile = None,
    report: Report = False,
    out: Out = REPORTS,
    date: Date = None,
    seed: Seed = 0,
    as_json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Contact, oil film, friction and leakage of one seal."""
    from .. import verbs

    if place not in ("piston", "rod"):
        raise UsageError(Diagnostic(f'--seal "{place}"', "write piston or rod"))
    check_targets(out if report or mapped else None, date, write)
    actuator = read_actuator(design, sets, plugin)
    study = verbs.seal(
        actuator,
        place=place,  # type: ignore[arg-type]
        speed=given("--speed", speed, INPUTS["speed"]),
        pressure=given("--pressure", pressure, INPUTS["pressure"]),
        mapped=mapped,
        curves=report,
        finite_elements=finite_elements,
    )
    if write is not None:
        verbs.save(verbs.with_contact(actuator, study), write)
    files = []
    if report or mapped:
        files = verbs.write_seal(
            study, folder=out, actuator=actuator, command=command_line(), date=date, sheet=report
        )
    shown = [file.to_dict() for file in files]
    if as_json:
        streams.out_json(study.to_dict() | ({"files": shown} if shown else {}))
    elif not quiet:
        from ..reporting.seal_text import seal_text

        streams.out(seal_text(study, **streams.style()), end="")
        say_files(([{"path": write}] if write is not None else []) + shown)
    if not study.converged:
        raise typer.Exit(ExitCode.SOLVER_FAILED)
