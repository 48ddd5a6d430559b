"""Commands for many variants of a design: `sweep` and `explore`."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ..base.bounds import SWEEP_FIGURES
from ..base.errors import ActuatorError, Diagnostic, ExitCode, UsageError, shown
from ..base.units import whole
from . import completion, streams
from .job import Job
from .options import (
    REPORTS,
    DesignFile,
    Json,
    NoRecord,
    PluginFile,
    Quiet,
    Scheduler,
    Seed,
    Set,
    Unset,
    UnusedSeed,
)

if TYPE_CHECKING:
    from ..sweeps import Swept

Vary = Annotated[
    list[str] | None,
    typer.Option(
        "--vary",
        metavar="PATH=A..B:N",
        autocompletion=completion.stated,
        help="Input to vary: a range with N values, or a list (PATH=a,b,c). Repeatable.",
    ),
]
Way = Annotated[
    str,
    typer.Option("--method", help="grid (every combination), sobol or lhs (Latin hypercube)."),
]
Count = Annotated[
    int | None, typer.Option("-n", metavar="N", help="Number of points for sobol or lhs.")
]
Store = Annotated[
    Path | None,
    typer.Option(
        "--store",
        metavar="F.db",
        help="Store every row in this database; a later run resumes from it.",
    ),
]
Csv = Annotated[
    Path | None, typer.Option("--csv", metavar="F.csv", help="Write all rows to this file.")
]
Parquet = Annotated[
    Path | None,
    typer.Option(
        "--parquet", metavar="F.parquet", help="Write all rows as Apache Parquet (extra parquet)."
    ),
]
Reduce = Annotated[
    str | None,
    typer.Option("--reduce", metavar="best:K", help="Keep only the K best designs."),
]
Workers = Annotated[
    int | None,
    typer.Option("--workers", metavar="N", help="Number of processes; default: all cores."),
]
Figures = Annotated[
    list[str] | None,
    typer.Option(
        "--figure",
        metavar="KIND",
        help=f"Draw {', '.join(SWEEP_FIGURES[:-1])} or {SWEEP_FIGURES[-1]} "
        "as PNG and SVG. Repeatable.",
    ),
]
Show = Annotated[
    list[str] | None,
    typer.Option(
        "--show",
        metavar="METRIC",
        help="Metric to draw; default: objective and requirements. Repeatable.",
    ),
]
Yes = Annotated[bool, typer.Option("--yes", help="Allow more than a million full evaluations.")]
Screening = Annotated[
    str,
    typer.Option(
        "--engine",
        help="numpy; gpu: all designs on a CUDA GPU (extra gpu); jax: --reduce by JAX (extra jax).",
    ),
]
Folder = Annotated[Path, typer.Option("--out", metavar="DIR", help="Folder of the figures.")]


def sweep(
    design: DesignFile,
    vary: Vary = None,
    method: Way = "grid",
    count: Count = None,
    store: Store = None,
    csv: Csv = None,
    parquet: Parquet = None,
    reduce: Reduce = None,
    workers: Workers = None,
    scheduler: Scheduler = None,
    figures: Figures = None,
    show: Show = None,
    engine: Screening = "numpy",
    yes: Yes = False,
    sets: Set = None,
    unset: Unset = None,
    plugin: PluginFile = None,
    seed: Seed = 0,
    no_record: NoRecord = False,
    as_json: Json = False,
    quiet: Quiet = False,
    out: Folder = REPORTS,
) -> ExitCode:
    """Evaluate many variants of a design."""
    from .. import api as verbs

    keep = _kept(reduce)
    if show and not figures:
        raise UsageError(Diagnostic("--show without --figure", "add e.g. --figure parallel"))
    job = Job(
        design, sets=sets, unset=unset, plugins=plugin, report=bool(figures), out=out,
        as_json=as_json, quiet=quiet,
    )  # fmt: skip
    figures, show = figures or [], show or []
    output: dict[str, Any] = {"store": store, "csv": csv, "parquet": parquet, "keep": keep}
    output |= {"figures": figures, "show": show}
    with _resumable(store, quiet):
        swept = job.run(
            verbs.sweep, vary=vary or [], method=method, n=count, seed=seed,
            reduce=reduce is not None, workers=workers, scheduler=scheduler, engine=engine, yes=yes,
            rows=False, **output,
        )  # fmt: skip
    if swept.study.engine != engine and not quiet:
        streams.err("JAX not installed (pip install 'actuator-opt[jax]'); used NumPy")
    if not no_record:
        job.keep(swept, **output)
    files, faults = _drawn(swept, figures, show, out)
    code = job.deliver(swept, files=files, saved=[csv, parquet], faults=faults)
    return ExitCode.BAD_INPUT if faults else code


@contextmanager
def _resumable(store: Path | None, quiet: bool) -> Iterator[None]:
    """If Ctrl-C ends a sweep that has a database, explain how to resume it."""
    try:
        yield
    except KeyboardInterrupt:
        if store is not None and not quiet:
            streams.err(
                f"{store} contains the rows computed so far; the same command resumes from there"
            )
        raise


def _drawn(
    swept: Swept, figures: list[str], show: list[str], out: Path
) -> tuple[list[dict[str, str]], list[Diagnostic]]:
    """Draw the figures; return their files, and faults of failed figures to report at the end."""
    from .. import api as verbs

    files: list[dict[str, str]] = []
    faults: dict[str, Diagnostic] = {}
    for figure in dict.fromkeys(figures):
        try:
            paths = verbs.draw_sweep(swept, [figure], show=show, out=out)
        except ActuatorError as error:
            faults |= {str(fault): fault for fault in error.diagnostics}
        else:
            files += [{"path": str(path)} for path in paths]
    return files, [*faults.values()]


def _kept(reduce: str | None) -> int:
    """Read the number of best designs to keep."""
    if reduce is None:
        return 10
    name, _, number = reduce.partition(":")
    keep = whole(number)
    if name != "best" or not keep:
        message = f"--reduce {shown(reduce)}: unknown"
        raise UsageError(Diagnostic(message, "write best:K, e.g. best:20"))
    return keep


def explore(
    store: Annotated[
        str,
        typer.Argument(
            metavar="RUN|F.db",
            help="Run of sweep or pareto (id or last), or the database of a sweep.",
        ),
    ],
    study: Annotated[
        int | None,
        typer.Option(
            "--study",
            metavar="N",
            help="Number of the study in the database; default: the newest.",
        ),
    ] = None,
    rows: Annotated[
        int,
        typer.Option(
            "--rows",
            metavar="N",
            help="Maximum number of designs shown; if there are more, an even sample is shown.",
        ),
    ] = 5000,
    out: Annotated[
        Path, typer.Option("--out", metavar="FILE", help="File (.html) or folder of the page.")
    ] = REPORTS,
    plugin: PluginFile = None,
    as_json: Json = False,
    quiet: Quiet = False,
    seed: UnusedSeed = 0,
) -> None:
    """Write a sweep or Pareto front as one offline HTML page."""
    from .. import api as verbs

    pages = verbs.explore(store, out=out, study=study, rows=rows, plugins=plugin or [])
    files = [file.to_dict() for file in pages]
    job = Job(as_json=as_json, quiet=quiet)
    job.answer(lambda: {"files": files}, remarks=pages[0].remarks, files=files)
