"""`sweep`: many variants of a design."""

from __future__ import annotations

from contextlib import nullcontext
from pathlib import Path
from typing import Annotated

import typer

from . import streams
from .cli_shared import read_actuator
from .errors import Diagnostic, ExitCode, UsageError
from .options import REPORTS, DesignFile, Json, PluginFile, Quiet, Seed, Set

METHODS = ("grid", "sobol", "lhs")


def sweep(
    design: DesignFile,
    vary: Annotated[
        list[str] | None,
        typer.Option(
            "--vary",
            metavar="PATH=A..B:N",
            help="A range with its steps, or a list: PATH=a,b,c. Repeatable.",
        ),
    ] = None,
    method: Annotated[
        str,
        typer.Option("--method", help="grid (every combination), sobol or lhs (Latin hypercube)."),
    ] = "grid",
    count: Annotated[
        int | None, typer.Option("-n", metavar="N", help="Points of sobol and lhs.")
    ] = None,
    store: Annotated[
        Path | None,
        typer.Option("--store", metavar="F.db", help="Keep every row here; a later run goes on."),
    ] = None,
    csv: Annotated[
        Path | None, typer.Option("--csv", metavar="F.csv", help="Write every row here.")
    ] = None,
    reduce: Annotated[
        str | None,
        typer.Option("--reduce", metavar="best:K", help="Keep the K best alone, nothing else."),
    ] = None,
    workers: Annotated[
        int | None, typer.Option("--workers", metavar="N", help="Processes; default: every core.")
    ] = None,
    scheduler: Annotated[
        str | None,
        typer.Option("--scheduler", metavar="ADDRESS", help="Work on this Dask cluster instead."),
    ] = None,
    yes: Annotated[
        bool, typer.Option("--yes", help="Keep more than a million points without asking.")
    ] = False,
    sets: Set = None,
    plugin: PluginFile = None,
    seed: Seed = 0,
    as_json: Json = False,
    quiet: Quiet = False,
    out: Annotated[Path, typer.Option("--out", hidden=True)] = REPORTS,
) -> None:
    """Evaluate many variants of a design."""
    from . import verbs

    keep = _kept(reduce, store, csv)
    if method not in METHODS:
        raise UsageError(Diagnostic(f"--method {method}: unknown", f"use {', '.join(METHODS)}"))
    if workers is not None and workers < 1:
        raise UsageError(Diagnostic(f"--workers {workers}", "give 1 or more"))
    actuator = read_actuator(design, sets, plugin)
    with nullcontext() if quiet else streams.watching():
        found = verbs.sweep(
            actuator,
            vary or [],
            method=method,  # type: ignore[arg-type]
            n=count,
            seed=seed,
            store=store,
            csv=csv,
            keep=keep,
            reduce=reduce is not None,
            workers=workers,
            scheduler=scheduler,
            yes=yes,
        )
    if as_json:
        streams.out_json(found.to_dict())
    else:
        from .reporting.sweep_text import sweep_text

        streams.out(sweep_text(found, **streams.style()))
        if not quiet and csv is not None:
            streams.err(f"wrote {csv}")
    if not found.feasible:
        raise typer.Exit(ExitCode.MISSED)


def _kept(reduce: str | None, store: Path | None, csv: Path | None) -> int:
    """How many of the best to keep."""
    if reduce is None:
        return 10
    if store is not None or csv is not None:
        raise UsageError(Diagnostic("--reduce keeps the best alone", "leave out --store and --csv"))
    name, _, number = reduce.partition(":")
    if name != "best" or not number.isdecimal() or int(number) < 1:
        raise UsageError(Diagnostic(f"--reduce {reduce}: unknown", "write best:K, e.g. best:20"))
    return int(number)
