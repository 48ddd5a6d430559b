"""`explore`: a kept sweep, or a front, as one page."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from . import streams
from .options import REPORTS, Json, PluginFile, Quiet
from .shared import say_files


def explore(
    store: Annotated[
        str,
        typer.Argument(
            metavar="RUN|F.db", help="Run of sweep or pareto (id, last), or a sweep's database."
        ),
    ],
    study: Annotated[
        int | None,
        typer.Option("--study", metavar="N", help="Which of its studies; default: the newest."),
    ] = None,
    rows: Annotated[
        int,
        typer.Option("--rows", metavar="N", help="Most designs shown; of more, an even sample."),
    ] = 5000,
    out: Annotated[
        Path, typer.Option("--out", metavar="FILE", help="The page (.html), or a folder for it.")
    ] = REPORTS,
    plugin: PluginFile = None,
    as_json: Json = False,
    quiet: Quiet = False,
    seed: Annotated[int, typer.Option("--seed", hidden=True)] = 0,
) -> None:
    """Write a kept sweep or a front as one offline HTML page."""
    from .. import verbs

    found = verbs.explore(store, out=out, study=study, rows=rows, plugins=plugin or [])
    files = [file.to_dict() for file in found]
    if as_json:
        streams.out_json({"files": files})
    elif not quiet:
        for remark in found[0].remarks:
            streams.err(remark)
        say_files(files)
