"""Sweep a design: many variants at once."""

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
"""Points from which a sweep that evaluates them all in full must be meant."""

MOST_WORKERS = 1024
"""Most processes of one machine (a choice: more are a slip, and may bring it down)."""


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
    design : the design that stands where nothing varies
    vary : ``"PATH=A..B:N"`` or ``"PATH=a,b,c"``, or these by PATH
    method : "grid" (full factorial), "sobol" or "lhs" (Latin hypercube)
    n : points of "sobol" and "lhs"
    seed : of "sobol" and "lhs"
    store : database to take rows from and put them into
    csv : file to write every row into
    parquet : the same as Apache Parquet, typed and with metadata (extra `parquet`)
    keep : best feasible designs to return
    reduce : whether only what tells the best is computed
    workers : processes; default: one per core
    scheduler : address of a Dask scheduler to work on instead (extra `cluster`)
    engine : what `reduce` screens with, "numpy" or "jax" (extra `gpu`); NumPy where JAX is missing
    yes : whether a sweep of a million points that are all evaluated in full is meant
    plugins : the user's metrics and constraints
    figures : "parallel", "scatter", "contour", "ucurves", drawn as PNG and SVG
    show : metrics of the figures; default: the objective and the requirements
    out : folder of the figures; without it they are only prepared for `draw_sweep`

    Raises
    ------
    UsageError
        nothing to vary, a form that is not one, a size that must be confirmed, or a figure that
        does not fit the sweep
    InputError
        a PATH or value that is none, an objective that the design has no value of, or a store that
        cannot be used
    """
    from ..sweeps import plan, read_axis, sweep as run
    from ..sweeps.engine import usable_engine

    engine = usable_engine(engine, reduced=reduce)
    if workers is not None and not 1 <= workers <= MOST_WORKERS:
        raise UsageError(Diagnostic(f"--workers {workers}", f"give 1 to {MOST_WORKERS}"))
    _require_apart(store, csv, parquet)
    if reduce and any(file is not None for file in (store, csv, parquet)):
        message = "--reduce keeps the best alone"
        raise UsageError(Diagnostic(message, "leave out --store, --csv and --parquet"))
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
        message = f"{chosen.count:,} points would all be evaluated in full".replace(",", " ")
        remedy = "add --yes, or keep the best alone with --reduce best:K"
        raise UsageError(Diagnostic(message, remedy))
    study = study_of(actuator, chosen, full=not reduce, show=show, engine=engine)
    if actuator.plugins and scheduler is not None:
        message = "own metrics cannot travel to other machines"
        raise UsageError(Diagnostic(message, "leave out --scheduler or --plugin"))
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
    """What writes a chunk into every file asked for, all in place once the last is complete."""
    from ..pages.sweep import SweepColumns, about
    from ..rendering.parquet import ParquetFile
    from ..rendering.series import CsvFile

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
    """Refuse an objective that the design has no value of; raises `InputError`."""
    from ..optimisation.actuator import goal_of

    goal_of(subject).value(compute(subject, subject.values()).computed, subject.cases)


def _require_apart(*files: str | Path | None) -> None:
    """Refuse one file for two things, and standard output; raises `UsageError`."""
    if "-" in map(str, files):
        message = "-: standard output carries the results"
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
    """The files that a design and its own metrics were read from."""
    design = [] if actuator.source is None else [actuator.source.file]
    return [*design, *(plugin.file for plugin in actuator.plugins if plugin.file)]


def free(actuator: Actuator) -> Design:
    """Its design, in which nothing is left to an optimiser."""
    return actuator.design.model_copy(update={"variables": {}, "choices": {}})


def study_of(
    actuator: Actuator, plan: Plan, *, full: bool, show: Sequence[str], engine: Engine = "numpy"
) -> Study:
    """What a sweep evaluates: the design, its points and the metrics wanted of them."""
    from ..sweeps.chunk import Study

    return Study(free(actuator), plan, actuator.plugins, full=full, more=tuple(show), engine=engine)


def _watched(study: Study, figures: Sequence[str], show: Sequence[str]) -> tuple[str, ...]:
    """The metrics whose Pareto lines figures need; a faulty figure is refused before the work."""
    if not figures:
        return ()
    from ..pages.sweep_figures.drawing import watched

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
    swept : what `sweep` came to
    figures : "parallel" (what varies, the objective, metrics), "scatter" (metrics in pairs with
        their Pareto lines), "contour" (of metrics over the two numbers of a grid, with the
        boundary of every limit), "ucurves" (stiffness over the stroke of the best designs)
    show : metrics; default: the objective and the requirements, in a contour the objective
    out, stem : where to; default: the design's name in ``reports/``

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
    At most 4096 of the feasible designs and of the others are kept to be drawn, an even choice of
    more, which the figure tells. Pareto lines are of every feasible design where the metrics were
    known before the sweep (``sweep(..., figures=["scatter"], show=...)``), and of those kept else.
    """
    from ..pages.sweep_figures.drawing import write_figures

    name = stem or Path(file_name(swept.study.design, None)).stem
    return write_figures(swept, figures, show, Path(out), name)
