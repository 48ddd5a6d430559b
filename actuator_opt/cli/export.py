"""The command `actuator-opt export`: a design as files for other programs."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from . import streams
from .options import REPORTS, DesignFile, Json, PluginFile, Quiet, Seed, Set
from .shared import check_targets, leave_by, read_actuator, say_files


def export(
    design: DesignFile,
    formats: Annotated[
        list[str] | None,
        typer.Option("--format", metavar="step|dxf|xlsx", help="File to write. Repeatable."),
    ] = None,
    sets: Set = None,
    out: Annotated[
        Path, typer.Option("--out", metavar="DIR", help="Folder of the files.")
    ] = REPORTS,
    date: Annotated[
        str | None,
        typer.Option(
            "--date",
            metavar="YYYY-MM-DD",
            help="Date to write into the files; default: none, or that of SOURCE_DATE_EPOCH.",
        ),
    ] = None,
    seed: Seed = 0,
    plugin: PluginFile = None,
    as_json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Write the design for CAD (STEP, DXF) or Excel (XLSX)."""
    from .. import verbs
    from ..exporting import require_formats

    asked = require_formats(formats or [])
    check_targets(out, date)
    actuator = read_actuator(design, sets, plugin)
    evaluation = verbs.evaluate(actuator)
    files = verbs.export(evaluation, formats=asked, folder=out, actuator=actuator, date=date)
    found = [file.to_dict() for file in files]
    if as_json:
        streams.out_json({"files": found})
    elif not quiet:
        say_files(found)
    leave_by(evaluation)
