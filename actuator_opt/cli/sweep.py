"""`sweep`: many variants of a design."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager, nullcontext
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ..bounds import SWEEP_FIGURES
from ..errors import ActuatorError, Diagnostic, ExitCode, InputError, UsageError
from ..suggest import shown
from ..units import whole
from . import streams
from .options import REPORTS, DesignFile, Json, NoRecord, PluginFile, Quiet, Seed, Set
from .shared import check_targets, command_line, keep_record, read_actuator, say_files

if TYPE_CHECKING:
    from ..variants import Swept

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
        help=f"Draw {', '.join([*SWEEP_FIGURES][:-1])} or {[*SWEEP_FIGURES][-1]} "
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
) -> None:
    """Evaluate many variants of a design."""
    from .. import verbs

    keep = _kept(reduce)
    if show and not figures:
        raise UsageError(Diagnostic("--show without --figure", "add --figure parallel, say"))
    if figures:
        check_targets(out, None)
    actuator = read_actuator(design, sets, plugin)
    asked: dict[str, Any] = {"store": store, "csv": csv, "parquet": parquet, "keep": keep}
    asked |= {"figures": figures or [], "show": show or []}
    with _kept_rows(store, quiet), nullcontext() if quiet else streams.watching():
        found = verbs.sweep(
            actuator,
            vary or [],
            method=method,  # type: ignore[arg-type]
            n=count,
            seed=seed,
            reduce=reduce is not None,
            workers=workers,
            scheduler=scheduler,
            engine=engine,  # type: ignore[arg-type]
            yes=yes,
            **asked,
        )
    if found.study.engine != engine and not quiet:
        streams.err("JAX is missing (pip install 'actuator-opt[gpu]'): NumPy did its work")
    if not no_record:
        asked["command"] = command_line()
        keep_record(lambda: verbs.record_sweep(found, actuator=actuator, **asked))
    files, fault = _drawn(found, figures or [], show or [], out)
    if as_json:
        _tell_json(found, files, fault)
    else:
        _tell(found, [csv, parquet], files, fault, quiet=quiet)
    if not found.best:
        raise typer.Exit(ExitCode.MISSED)


@contextmanager
def _kept_rows(store: Path | None, quiet: bool) -> Iterator[None]:
    """Where Ctrl-C ends a sweep with a store, say how it goes on."""
    try:
        yield
    except KeyboardInterrupt:
        if store is not None and not quiet:
            streams.err(f"{store} keeps the rows so far; the same command goes on from there")
        raise


def _tell_json(found: Swept, files: list[dict[str, str]], fault: ActuatorError | None) -> None:
    """One object; a figure that could not be drawn is told beside the results."""
    told = found.to_dict() | ({"files": files} if files else {})
    faults = [] if fault is None else [one.to_dict() for one in fault.diagnostics]
    streams.out_json(told | ({"errors": faults} if faults else {}))
    if fault is not None:
        raise typer.Exit(fault.exit_code)


def _tell(
    found: Swept,
    tables: list[Path | None],
    files: list[dict[str, str]],
    fault: ActuatorError | None,
    *,
    quiet: bool,
) -> None:
    """Results as text, then the files, then what could not be drawn."""
    from ..reporting.sweep_text import sweep_text

    if not quiet:
        streams.out(sweep_text(found, **streams.style()))
        for path in filter(None, tables):
            streams.err(f"wrote {path}")
        say_files(files)
    if fault is not None:
        raise fault


def _drawn(
    found: Swept, figures: list[str], show: list[str], out: Path
) -> tuple[list[dict[str, str]], ActuatorError | None]:
    """The files of figures, and the faults of the others, told once the sweep's results are."""
    from .. import verbs

    files: list[dict[str, str]] = []
    faults: dict[str, Diagnostic] = {}
    for figure in dict.fromkeys(figures):
        try:
            paths = verbs.draw_sweep(found, [figure], show=show, out=out)
        except ActuatorError as error:
            faults |= {str(one): one for one in error.diagnostics}
        else:
            files += [{"path": str(path)} for path in paths]
    return files, InputError(list(faults.values())) if faults else None


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
