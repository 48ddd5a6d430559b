"""Sweep a design: evaluate many variants."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..base.errors import Diagnostic, InputError, UsageError
from ..base.files import require_apart, writing as cannot_write
from ..design import Design
from ..evaluation import PreparedDesign, compute
from .actuator import Actuator, Plugins, as_actuator, unanswered
from .reports import file_name

if TYPE_CHECKING:
    from ..sweeps import Swept
    from ..sweeps.chunk import Chunk, Study
    from ..sweeps.engine import Engine
    from ..sweeps.plan import Method, Plan

LARGE = 1_000_000
"""Number of points from which a full sweep needs confirmation."""

MOST_WORKERS = 1024
"""Maximum processes on one machine (a choice: more are probably a slip, and may overload it)."""


def sweep(
    design: Actuator | Design | str | Path,
    vary: Sequence[str] | Mapping[str, str],
    *,
    method: Method = "grid",
    n: int | None = None,
    seed: int = 0,
    store: str | Path | None = None,
    csv: str | Path | None = None,
    parquet: str | Path | None = None,
    keep: int = 10,
    reduce: bool = False,
    workers: int | None = None,
    scheduler: str | None = None,
    engine: Engine = "numpy",
    yes: bool = False,
    plugins: Plugins = (),
    figures: Sequence[str] = (),
    show: Sequence[str] = (),
    out: str | Path | None = None,
) -> Swept:
    """Evaluate many variants of a design.

    Parameters
    ----------
    design : the base design
    vary : ``"PATH=A..B:N"`` or ``"PATH=a,b,c"``, or these by PATH
    method : "grid" (full factorial), "sobol" or "lhs" (Latin hypercube)
    n : points of "sobol" and "lhs"
    seed : of "sobol" and "lhs"
    store : database to read rows from and write them to
    csv : file for every row
    parquet : the same as Apache Parquet, typed and with metadata (extra `parquet`)
    keep : best feasible designs to return
    reduce : compute only what is needed to find the best
    workers : processes; default: one per core
    scheduler : address of a Dask scheduler, used instead of local processes (extra `cluster`)
    engine : array library of the screen of `reduce`, "numpy" or "jax" (extra `gpu`); NumPy if JAX
        is missing
    yes : confirms a full sweep of a million points or more
    plugins : the user's metrics and constraints
    figures : "parallel", "scatter", "contour", "ucurves", drawn as PNG and SVG
    show : metrics of the figures; default: the objective and the requirements
    out : folder of the figures; without it they are only prepared for `draw_sweep`

    Raises
    ------
    UsageError
        nothing to vary, an invalid form, a size that must be confirmed, or a figure that does not
        fit the sweep
    InputError
        an invalid PATH or value, an objective without a value, or a store that cannot be used
    """
    from ..sweeps import plan, read_axis, sweep as run
    from ..sweeps.engine import usable_engine

    engine = usable_engine(engine, reduced=reduce)
    if workers is not None and not 1 <= workers <= MOST_WORKERS:
        raise UsageError(Diagnostic(f"--workers {workers}", f"give 1 to {MOST_WORKERS}"))
    _require_apart(store, csv, parquet)
    if reduce and any(file is not None for file in (store, csv, parquet)):
        message = "--reduce only keeps the best designs"
        raise UsageError(Diagnostic(message, "omit --store, --csv and --parquet"))
    actuator = as_actuator(design, plugins)
    for file in (store, csv, parquet):
        if file is not None:
            require_apart(Path(file), *_read_from(actuator))
    subject = actuator.subject()
    faults = unanswered(actuator, subject)
    if faults:
        raise InputError(faults)
    _require_objective(subject)
    base = free(actuator)
    given = [f"{k}={v}" for k, v in vary.items()] if isinstance(vary, Mapping) else list(vary)
    axes = [read_axis(text, base, subject.quantities) for text in given]
    chosen = plan(axes, method=method, count=n, seed=seed)
    if chosen.count > LARGE and not reduce and not yes:
        message = f"all {chosen.count:,} points would be evaluated in full".replace(",", " ")
        remedy = "confirm with --yes, or keep only the best with --reduce best:K"
        raise UsageError(Diagnostic(message, remedy))
    study = study_of(actuator, chosen, full=not reduce, show=show, engine=engine)
    if actuator.plugins and scheduler is not None:
        message = "custom metrics cannot be sent to other machines"
        raise UsageError(Diagnostic(message, "omit --scheduler or --plugin"))
    how: dict[str, Any] = {
        "store": None if store is None else Path(store),
        "keep": keep,
        "workers": 1 if actuator.plugins or engine != "numpy" else workers,
        "scheduler": scheduler,
        "watch": _watched(study, figures, show),
    }
    with writing(study, csv, parquet) as each:
        found = run(study, each=each, **how)
    if figures and out is not None:
        draw_sweep(found, figures, show=show, out=out)
    return found


@contextmanager
def writing(
    study: Study, csv: str | Path | None, parquet: str | Path | None
) -> Iterator[Callable[[Chunk], None]]:
    """Write chunks to all requested files, which appear once all are complete."""
    from ..pages.sweep import SweepColumns, about
    from ..rendering.series import CsvFile, ParquetFile

    columns = SweepColumns(study)
    with ExitStack() as stack:
        files: list[CsvFile | ParquetFile] = []
        if csv is not None:
            files.append(stack.enter_context(CsvFile(columns.fields, Path(csv))))
        if parquet is not None:
            file = ParquetFile(columns.fields, about(study), Path(parquet))
            files.append(stack.enter_context(file))

        def each(chunk: Chunk) -> None:
            values = columns.values(chunk) if files else []
            for file in files:
                file.add(values)

        yield each


def _require_objective(subject: PreparedDesign) -> None:
    """Reject an objective without a value; raises `InputError`."""
    from ..optimisation.actuator import goal_of

    goal_of(subject).value(compute(subject, subject.values()).computed, subject.cases)


def _require_apart(*files: str | Path | None) -> None:
    """Reject one file for two purposes, and standard output; raises `UsageError`."""
    if "-" in map(str, files):
        message = "-: standard output is used for the results"
        raise UsageError(Diagnostic(message, "name a file for --store, --csv or --parquet"))
    places = []
    for path in (Path(file) for file in files if file is not None):
        with cannot_write(path):
            places.append(path.resolve())
    for place in places:
        if places.count(place) > 1:
            message = f"{place.name}: one file for two of --store, --csv and --parquet"
            raise UsageError(Diagnostic(message, "name another file"))


def _read_from(actuator: Actuator) -> list[str]:
    """The files that a design and its custom metrics were read from."""
    design = [] if actuator.source is None else [actuator.source.file]
    return [*design, *(plugin.file for plugin in actuator.plugins if plugin.file)]


def free(actuator: Actuator) -> Design:
    """Its design without free variables."""
    return actuator.design.model_copy(update={"variables": {}, "choices": {}})


def study_of(
    actuator: Actuator, plan: Plan, *, full: bool, show: Sequence[str], engine: Engine = "numpy"
) -> Study:
    """The study of a sweep: the design, its points and the requested metrics."""
    from ..sweeps.chunk import Study

    return Study(free(actuator), plan, actuator.plugins, full=full, more=tuple(show), engine=engine)


def _watched(study: Study, figures: Sequence[str], show: Sequence[str]) -> tuple[str, ...]:
    """The metrics for Pareto lines of the figures; rejects an invalid figure before the work."""
    if not figures:
        return ()
    from ..pages.sweep_figures.shared import watched

    return watched(study, figures, show)


def draw_sweep(
    swept: Swept,
    figures: Sequence[str],
    *,
    show: Sequence[str] = (),
    out: str | Path = "reports",
    stem: str | None = None,
) -> list[Path]:
    """Draw figures of a sweep as PNG and SVG.

    Parameters
    ----------
    swept : result of `sweep`
    figures : "parallel" (what varies, the objective, metrics), "scatter" (metrics in pairs with
        their Pareto lines), "contour" (of metrics over the two numbers of a grid, with the
        boundary of every limit), "ucurves" (stiffness over the stroke of the best designs)
    show : metrics; default: the objective and the requirements, in a contour the objective
    out, stem : target; default: the design's name in ``reports/``

    Returns
    -------
    the files

    Raises
    ------
    UsageError
        no such figure or metric, or a sweep that does not fit it
    InputError
        no feasible design, a metric without values, or a folder that cannot be written

    Notes
    -----
    At most 4096 of the feasible designs and of the others are drawn, sampled evenly, with a note in
    the figure. Pareto lines cover every feasible design if the metrics were known before the sweep
    (``sweep(..., figures=["scatter"], show=...)``), else only the sample.
    """
    from ..pages.sweep_figures.shared import write_figures

    name = stem or Path(file_name(swept.study.design, None)).stem
    return write_figures(swept, figures, show, Path(out), name)
