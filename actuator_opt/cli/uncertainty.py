"""`uncertainty`: what scatter does to a design."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from ..errors import ExitCode
from ..store import require_apart
from . import streams
from .options import REPORTS, Date, DesignFile, Json, Out, PluginFile, Quiet, Report, Seed, Set
from .shared import check_targets, command_line, read_actuator, say_files

Draws = Annotated[
    int, typer.Option("-n", "--samples", metavar="N", help="Draws of the yield, 20 to 10 million.")
]
Quasi = Annotated[
    bool,
    typer.Option("--quasi", help="Draw scrambled Sobol points, 16 times: narrower bounds."),
]
Rows = Annotated[
    int,
    typer.Option(
        "--index-rows",
        min=0,
        max=1_000_000,
        metavar="N",
        help="Rows behind the indices, inputs + 2 evaluations each; 0 for none.",
    ),
]
Metrics = Annotated[
    list[str] | None,
    typer.Option(
        "--metric",
        metavar="METRIC",
        help="Follow this metric too; default: those of the objective. Repeatable.",
    ),
]


def uncertainty(
    design: DesignFile,
    count: Draws = 10_000,
    quasi: Quasi = False,
    rows: Rows = 1024,
    metric: Metrics = None,
    csv: Annotated[
        Path | None,
        typer.Option("--csv", metavar="FILE", help="Save draws: inputs, margins, what held."),
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
    """Yield, indices and tornado from scatter and tolerances."""
    from .. import verbs

    check_targets(out if report else None, date, csv)
    if csv is not None:
        require_apart(csv, design)
    actuator = read_actuator(design, sets, plugin)
    with streams.watching():
        found = verbs.uncertainty(
            actuator, count=count, seed=seed, quasi_random=quasi, rows=rows, metrics=metric or []
        )
    files: list[dict[str, Any]] = []
    if csv is not None:
        files.append(verbs.write_draws(found, csv).to_dict())
    if report:
        files += [
            file.to_dict()
            for file in verbs.write_uncertainty(
                found, folder=out, actuator=actuator, command=command_line(), date=date
            )
        ]
    if as_json:
        streams.out_json(found.to_dict() | ({"files": files} if files else {}))
    elif not quiet:
        from ..reporting.uncertainty_text import uncertainty_text

        streams.out(uncertainty_text(found, **streams.style()), end="")
        say_files(files)
    if not found.met:
        raise typer.Exit(ExitCode.MISSED)
