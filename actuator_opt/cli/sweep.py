"""Many variants of a design: `sweep` and `explore`."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ..base.bounds import SWEEP_FIGURES
from ..base.errors import ActuatorError, Diagnostic, ExitCode, UsageError
from ..base.suggest import shown
from ..base.units import whole
from . import streams
from .job import Job
from .options import REPORTS, DesignFile, Json, NoRecord, PluginFile, Quiet, Seed, Set

if TYPE_CHECKING:
    from ..sweeps import Swept

Vary = Annotated[
    list[str] | None,
    typer.Option(
        "--vary",
        metavar="PATH=A..B:N",
        help="A range with its steps, or a list: PATH=a,b,c. Repeatable.",
    ),
]
Way = Annotated[
    str,
    typer.Option("--method", help="grid (every combination), sobol or lhs (Latin hypercube)."),
]
Count = Annotated[int | None, typer.Option("-n", metavar="N", help="Points of sobol and lhs.")]
Store = Annotated[
    Path | None,
    typer.Option("--store", metavar="F.db", help="Keep every row here; a later run goes on."),
]
Csv = Annotated[Path | None, typer.Option("--csv", metavar="F.csv", help="Write every row here.")]
Parquet = Annotated[
    Path | None,
    typer.Option(
        "--parquet", metavar="F.parquet", help="The same as Apache Parquet (extra parquet)."
    ),
]
Reduce = Annotated[
    str | None,
    typer.Option("--reduce", metavar="best:K", help="Keep the K best alone, nothing else."),
]
Workers = Annotated[
    int | None, typer.Option("--workers", metavar="N", help="Processes; default: every core.")
]
Scheduler = Annotated[
    str | None,
    typer.Option("--scheduler", metavar="ADDRESS", help="Work on this Dask cluster instead."),
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
        help="A metric of the figures; default: the objective and requirements. Repeatable.",
    ),
]
Yes = Annotated[
    bool, typer.Option("--yes", help="Evaluate a million points in full without asking.")
]
Screening = Annotated[
    str,
    typer.Option("--engine", help="What --reduce screens with: numpy, or jax (extra gpu)."),
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
        raise UsageError(Diagnostic("--show without --figure", "add --figure parallel, say"))
    job = Job(
        design, sets=sets, plugins=plugin, report=bool(figures), out=out,
        as_json=as_json, quiet=quiet,
    )  # fmt: skip
    asked: dict[str, Any] = {"store": store, "csv": csv, "parquet": parquet, "keep": keep}
    asked |= {"figures": figures or [], "show": show or []}
    how: dict[str, Any] = {"vary": vary or [], "yes": yes, "engine": engine}
    how |= {"method": method, "n": count, "seed": seed, "workers": workers, "scheduler": scheduler}
    how |= {"reduce": reduce is not None}
    with _kept_rows(store, quiet):
        found = job.run(verbs.sweep, **asked, **how)
    if found.study.engine != engine and not quiet:
        streams.err("JAX is missing (pip install 'actuator-opt[gpu]'): NumPy did its work")
    if not no_record:
        job.keep(found, **asked)
    files, faults = _drawn(found, asked["figures"], asked["show"], out)
    code = job.deliver(found, files=files, saved=[csv, parquet], faults=faults)
    return ExitCode.BAD_INPUT if faults else code


@contextmanager
def _kept_rows(store: Path | None, quiet: bool) -> Iterator[None]:
    """Where Ctrl-C ends a sweep with a store, say how it goes on."""
    try:
        yield
    except KeyboardInterrupt:
        if store is not None and not quiet:
            streams.err(f"{store} keeps the rows so far; the same command goes on from there")
        raise


def _drawn(
    found: Swept, figures: list[str], show: list[str], out: Path
) -> tuple[list[dict[str, str]], list[Diagnostic]]:
    """The files of figures, and the faults of the others, told once the sweep's results are."""
    from .. import api as verbs

    files: list[dict[str, str]] = []
    faults: dict[str, Diagnostic] = {}
    for figure in dict.fromkeys(figures):
        try:
            paths = verbs.draw_sweep(found, [figure], show=show, out=out)
        except ActuatorError as error:
            faults |= {str(fault): fault for fault in error.diagnostics}
        else:
            files += [{"path": str(path)} for path in paths]
    return files, [*faults.values()]


def _kept(reduce: str | None) -> int:
    """How many of the best to keep."""
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
    from .. import api as verbs

    found = verbs.explore(store, out=out, study=study, rows=rows, plugins=plugin or [])
    files = [file.to_dict() for file in found]
    job = Job(as_json=as_json, quiet=quiet)
    job.answer(lambda: {"files": files}, remarks=found[0].remarks, files=files)
