"""Sweeps a design (evaluates many variants), and draws or lists a recorded sweep again."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias, Unpack

from ..base.arguments import guarded
from ..base.dataclass import dataclass
from ..base.errors import Diagnostic, InputError, UsageError, remedy, shown
from ..base.files import require_apart, writing as cannot_write
from ..base.numeric import Array
from ..base.tables import Displayed
from ..design import Design
from ..evaluation import PreparedDesign, compute
from .actuator import Actuator, Plugins, Result, as_actuator, requirement_faults, workers_for
from .recorded_runs import Run
from .reports import ReportArguments, file_name, report_files

if TYPE_CHECKING:
    from ..pages import ReportFile
    from ..rendering.tables import DataTable
    from ..sweeps import Swept
    from ..sweeps.chunk import Chunk, Study
    from ..sweeps.plan import Method, Plan
    from ..sweeps.screen import Engine

LARGE = 1_000_000
"""A full sweep of more points than this must be confirmed by the user."""

MOST_KEPT = 2**28
"""Largest number of values that a sweep keeps in memory unless asked to: 2 GB (our choice)."""

Varied: TypeAlias = "str | Sequence[float | str] | Array"
"""Values of a PATH: a text such as ``"18..40 mm:12"``, or numbers (SI) and texts with units."""

MOST_WORKERS = 1024
"""Maximum number of processes on a machine: our choice; a larger number is probably a typing error
and may overload the machine."""


@guarded
def sweep(
    design: Actuator | Design | Result | str | Path,
    vary: Sequence[str] | Mapping[str, Varied],
    *,
    method: Method = "grid",
    n: int | None = None,
    seed: int = 0,
    metrics: Sequence[str] | None = None,
    rows: bool | None = None,
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
    vary : ``"PATH=A..B:N"`` (N values from A to B) or ``"PATH=a,b,c"``, several in a list; or a
        mapping of each PATH to such a text, or to a list or array of numbers (SI) and texts, each
        with its own unit
    method : "grid" (full factorial), "sobol" or "lhs" (Latin hypercube)
    n : number of points for "sobol" and "lhs"
    seed : seed for "sobol" and "lhs"
    metrics : metrics in the rows of a full sweep, besides mass and objective; default: all
    rows : whether to keep all rows in memory, for `Swept.table` and `Swept.to_frame`; default: if
        they take less than 2 GB and no file is written
    store : database file; rows already in it are reused, and new rows are added
    csv : CSV file to write, with one row for each design
    parquet : the same table as an Apache Parquet file, with data types and metadata (extra
        `parquet`)
    keep : number of best feasible designs to return
    reduce : whether to skip designs that cannot be among the best, and so evaluate fewer
    workers : number of processes; default: one per core
    scheduler : address of a Dask scheduler, used instead of local processes (extra `cluster`)
    engine : "gpu" runs the recorded models of a full sweep on a CUDA GPU (extra `gpu`); its rows
        agree with those of the processor to rounding; not yet measured on a GPU. "jax" (extra
        `jax`) compiles the expressions with which `reduce` rules out designs; NumPy is used if JAX
        is missing
    yes : whether a full sweep of more than a million points is confirmed
    plugins : the user's metrics and constraints
    figures : figures to draw as PNG and SVG: "parallel", "scatter", "contour", "ucurves"
    show : metrics in the figures; default: the objective and the requirements
    out : folder of the figures; if missing, they are only prepared for `draw_sweep`

    Raises
    ------
    UsageError
        nothing varies, a range is written in an invalid form, the size must be confirmed, or a
        figure does not fit the sweep
    InputError
        a PATH or value is invalid, the objective has no value, or the store cannot be used

    Examples
    --------
    >>> import numpy as np
    >>> vary = {"cylinder.bore": np.linspace(0.02, 0.03, 5), "rod.material": ["steel_42crmo4"]}
    >>> swept = sweep("designs/steel_baseline.yaml", vary)
    >>> swept.table()
    <DataTable 'steel knee': 5 rows, 169 columns>
    """
    from ..sweeps import sweep as run
    from ..sweeps.screen import usable_engine

    engine = usable_engine(engine, reduced=reduce)
    _require_workers(workers)
    files = [Path(file) for file in (store, csv, parquet) if file is not None]
    _require_distinct(files, reduced=reduce)
    actuator = as_actuator(design, plugins)
    for file in files:
        require_apart(file, *_read_from(actuator))
    subject = _sweepable(actuator)
    only = _only(metrics, subject.quantities, store)
    points = _points(actuator, subject, vary, method, n, seed)
    if not reduce and not yes:
        _require_few(points.count)
    if engine == "gpu":
        _require_gpu(actuator, scheduler)
    study = study_of(actuator, points, full=not reduce, show=show, engine=engine, only=only)
    watched = _watched(study, figures, show)
    with (
        workers_for(actuator, scheduler) as cluster,
        writing(study, csv, parquet) as write_rows,
    ):
        swept = run(
            study,
            each=write_rows,
            store=None if store is None else Path(store),
            keep=keep,
            workers=1 if actuator.plugins or engine != "numpy" else workers,
            cluster=cluster,
            watch=watched,
            rows=_keeps_rows(study, files) if rows is None else rows and not reduce,
        )
    if figures and out is not None:
        draw_sweep(swept, figures, show=show, out=out)
    return swept


@guarded
def evaluate_many(
    design: Actuator | Design | Result | str | Path,
    columns: Mapping[str, Sequence[float | str] | Array],
    *,
    metrics: Sequence[str] | None = None,
    plugins: Plugins = (),
    workers: int | None = None,
) -> DataTable:
    """Evaluate many variants of a design that are all given, value k of each PATH for variant k.

    The models evaluate all variants together, as in `sweep`; many variants run as a compiled
    program.

    Parameters
    ----------
    design : the base design
    columns : for each PATH, a list or one-dimensional array of numbers (SI) and texts, each with
        its own unit; all of one length
    metrics : metrics to return, besides mass and objective; default: all
    plugins : the user's metrics and constraints
    workers : number of processes; default: one per core

    Returns
    -------
    the given values, the metrics, `met` (whether every requirement and check is met),
    `least_margin` with its `governing_limit`, and `failure` (why a variant has no values)

    Raises
    ------
    InputError
        a PATH or value is invalid, an array is not one-dimensional or not finite, or the arrays
        have different lengths; the message states PATH and index
    UsageError
        there are no values, or a metric is unknown
    """
    from ..sweeps import paired, sweep as run

    _require_workers(workers)
    if not isinstance(columns, Mapping):
        message = f"columns: must be a mapping from PATH to values, not {type(columns).__name__}"
        raise UsageError(Diagnostic(message, 'write e.g. {"cylinder.bore": [0.02, 0.03]}'))
    actuator = as_actuator(design, plugins)
    subject = _sweepable(actuator)
    points = paired(columns, without_variables(actuator), subject.quantities)
    study = study_of(actuator, points, full=True, show=(), only=_only(metrics, subject.quantities))
    processes = 1 if actuator.plugins else workers
    return run(study, keep=0, workers=processes, rows=True).table()


def _only(
    metrics: Sequence[str] | None, known: Mapping[str, object], store: object = None
) -> tuple[str, ...] | None:
    """The metrics in the rows; None: all."""
    if metrics is None:
        return None
    if store is not None:
        message = "metrics: a store keeps all metrics"
        raise UsageError(Diagnostic(message, "omit metrics or store"))
    names = (metrics,) if isinstance(metrics, str) else tuple(metrics)
    for name in names:
        if name not in known:
            raise UsageError(Diagnostic(f'no metric "{shown(name)}"', remedy(str(name), known)))
    return names


def _keeps_rows(study: Study, files: Sequence[Path]) -> bool:
    """Whether to keep the rows in memory, unless the user states it (see `sweep`)."""
    return study.full and not files and len(study.columns) * study.plan.count <= MOST_KEPT


def _require_workers(workers: int | None) -> None:
    if workers is not None and not 1 <= workers <= MOST_WORKERS:
        raise UsageError(Diagnostic(f"--workers {workers}", f"give 1 to {MOST_WORKERS}"))


def _require_gpu(actuator: Actuator, scheduler: str | None) -> None:
    """Reject custom metrics, and a computer without a GPU unless a cluster computes the sweep."""
    from ..base.symbolic import gpu

    if actuator.plugins:
        message = "custom metrics cannot run on a GPU"
        raise UsageError(Diagnostic(message, "omit --engine or --plugin"))
    if scheduler is None:
        gpu.require()


@contextmanager
def writing(
    study: Study, csv: str | Path | None, parquet: str | Path | None
) -> Iterator[Callable[[Chunk], None]]:
    """Write chunks of rows to all requested files; no file appears before all are complete."""
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

        def write_rows(chunk: Chunk) -> None:
            values = columns.values(chunk) if files else []
            for file in files:
                file.add(values)

        yield write_rows


def _sweepable(actuator: Actuator) -> PreparedDesign:
    """The design in the form that the models take.

    Raises
    ------
    InputError : a requirement is on a metric that does not exist, or the objective has no value
    """
    from ..optimisation.actuator import goal_of

    subject = actuator.subject()
    faults = requirement_faults(actuator, subject)
    if faults:
        raise InputError(faults)
    goal_of(subject).value(compute(subject, subject.values()).computed, subject.cases)
    return subject


def _points(
    actuator: Actuator,
    subject: PreparedDesign,
    vary: Sequence[str] | Mapping[str, Varied],
    method: Method,
    count: int | None,
    seed: int,
) -> Plan:
    """The points of a sweep; arguments as for `sweep`."""
    from ..sweeps import given_axis, plan, read_axis

    base = without_variables(actuator)
    if isinstance(vary, Mapping):
        axes = [given_axis(path, values, base, subject.quantities) for path, values in vary.items()]
    else:
        texts = [vary] if isinstance(vary, str) else list(vary)
        axes = [read_axis(text, base, subject.quantities) for text in texts]
    return plan(axes, method=method, count=count, seed=seed)


def _require_few(count: int) -> None:
    """Reject a full sweep of too many points that is not confirmed; raises `UsageError`."""
    if count > LARGE:
        message = f"all {count:,} points would be evaluated in full".replace(",", " ")
        remedy = "confirm with --yes, or keep only the best with --reduce best:K"
        raise UsageError(Diagnostic(message, remedy))


def _require_distinct(files: Sequence[Path], *, reduced: bool) -> None:
    """Reject files of a reduced sweep, standard output, and a file that is given twice.

    Raises `UsageError`.
    """
    if reduced and files:
        message = "--reduce keeps only the best designs, so there are no other rows to write"
        raise UsageError(Diagnostic(message, "omit --store, --csv and --parquet"))
    if Path("-") in files:
        message = "-: standard output is used for the results"
        raise UsageError(Diagnostic(message, "name a file for --store, --csv or --parquet"))
    places = []
    for path in files:
        with cannot_write(path):
            places.append(path.resolve())
    for place in places:
        if places.count(place) > 1:
            message = f"{place.name}: two of --store, --csv and --parquet name this file"
            raise UsageError(Diagnostic(message, "name another file"))


def _read_from(actuator: Actuator) -> list[str]:
    """The files from which a design and its custom metrics are read."""
    design = [] if actuator.source is None else [actuator.source.file]
    return [*design, *(plugin.file for plugin in actuator.plugins if plugin.file)]


def without_variables(actuator: Actuator) -> Design:
    """The design with its variables and choices removed."""
    return actuator.design.model_copy(update={"variables": {}, "choices": {}})


def study_of(
    actuator: Actuator,
    plan: Plan,
    *,
    full: bool,
    show: Sequence[str],
    engine: Engine = "numpy",
    only: tuple[str, ...] | None = None,
) -> Study:
    """The study behind a sweep: the design, its points and the requested metrics."""
    from ..sweeps.chunk import Study

    return Study(
        without_variables(actuator),
        plan,
        actuator.plugins,
        full=full,
        more=tuple(show),
        only=only,
        engine=engine,
    )


def _watched(study: Study, figures: Sequence[str], show: Sequence[str]) -> tuple[str, ...]:
    """Metrics for which the figures draw Pareto lines; raises `UsageError` for invalid figures."""
    if not figures:
        return ()
    from ..pages.sweep_figures.shared import watched

    return watched(study, figures, show)


@guarded
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
    figures : "parallel" (varied inputs, objective, metrics), "scatter" (metrics in pairs with their
        Pareto lines), "contour" (metrics against the two numbers of a grid, with the boundary of
        every limit), "ucurves" (stiffness along the stroke, for the best designs)
    show : metrics to draw; default: the objective and the requirements, but for a contour only the
        objective
    out, stem : folder and name of the files; default: the design's name in ``reports/``

    Returns
    -------
    the files

    Raises
    ------
    UsageError
        a figure or metric is unknown or does not fit the sweep
    InputError
        no design is feasible, a metric has no values, or the folder cannot be written

    Notes
    -----
    At most 4096 feasible and 4096 infeasible designs are drawn, sampled evenly, with a note in the
    figure. Pareto lines cover every feasible design if the metrics were known before the sweep
    (``sweep(..., figures=["scatter"], show=...)``); otherwise they only cover the sample.
    """
    from ..pages.sweep_figures.shared import write_figures

    name = stem or Path(file_name(swept.study.design, None)).stem
    return write_figures(swept, figures, show, Path(out), name)


@dataclass(frozen=True, slots=True)
class KeptSweep(Displayed):
    """A sweep restored from its record: its study, and the run, which states where the rows are."""

    run: Run
    study: Study

    @property
    def in_short(self) -> tuple[str, str]:
        """The run, and its number of designs."""
        return self.study.design.name, f"run {self.run.id}, {self.study.plan.count} designs"


def kept_sweep(run: Run, actuator: Actuator) -> KeptSweep:
    """The sweep of a record; its rows are not read yet."""
    options = run.body["asked"]
    study = study_of(actuator, _plan(run), full=not options["reduce"], show=options["show"])
    return KeptSweep(run, study)


def _plan(run: Run) -> Plan:
    """The points that a record states; raises `ValueError` if the record is damaged."""
    import numpy as np

    from ..sweeps.plan import SweepAxis, plan

    record: dict[str, Any] = run.body["plan"]
    axes = [
        SweepAxis(
            axis["path"],
            None if axis["values"] is None else np.array(axis["values"], dtype=float),
            tuple(axis["texts"]),
            axis["range"],
            axis["steps"],
        )
        for axis in record["axes"]
    ]
    for axis in axes:
        ends = axis.range and axis.values is not None and len(axis.values) == 2
        steps = axis.count is None or axis.count >= 2
        if not (ends and steps if axis.range else axis.size):
            raise ValueError("an axis without values")
    count = None if record["method"] == "grid" else record["count"]
    try:
        points = plan(axes, method=record["method"], count=count, seed=run.head["seed"])
    except UsageError as error:
        raise ValueError(str(error)) from None
    if points.count != record["count"]:
        raise ValueError("another number of points")
    return points


def store_of(run: Run) -> tuple[Path, str]:
    """The database with a sweep's rows, and the hash of its study there.

    Raises
    ------
    InputError : the sweep has no database, or the file has moved
    """
    if run.head.get("kind") != "sweep":
        message = f"is a run of {run.head.get('kind')}, which has no stored rows"
        raise InputError(Diagnostic(message, "name a run of sweep or pareto", str(run.path)))
    store = run.body["asked"]["store"]
    if store is None:
        message = f"run {run.id} is a sweep without --store, so its rows were not stored"
        remedy = "see its best designs with runs show, or run it again with --store F.db"
        raise InputError(Diagnostic(message, remedy, str(run.path)))
    path = Path(store["path"])
    if not path.exists():
        message = f"no longer exists; run {run.id} stored its rows there"
        remedy = "restore it, or name its new location: actuator-opt explore F.db"
        raise InputError(Diagnostic(message, remedy, str(path)))
    return path, store["study"]


def report_sweep(sweep_record: KeptSweep, **paper: Unpack[ReportArguments]) -> list[ReportFile]:
    """Write the figures and tables of a recorded sweep again, from the rows in its database.

    The figures are those of the sweep, or else parallel axes if a design is feasible. The CSV file
    (``NAME-sweep.csv``) is omitted if the sweep has more than a million points and wrote no CSV
    file itself. A Parquet file is written if the sweep wrote one. Only folder and stem of `paper`
    are used (see `report`).

    Raises
    ------
    InputError : the database is missing, was made with other models or lacks rows of the sweep; or
        the folder cannot be written
    """
    from ..base.files import require_folder
    from ..pages.sweep_figures.shared import watched
    from ..sweeps import swept_again

    target = Path(paper.get("folder", "reports"))
    options, study = sweep_record.run.body["asked"], sweep_record.study
    path, _ = store_of(sweep_record.run)
    require_folder(target)
    figures, show = options["figures"], options["show"]
    watch = watched(study, figures, show)
    stem = paper.get("stem") or Path(file_name(study.design, None)).stem
    csv = parquet = None
    if study.plan.count <= LARGE or options["csv"] is not None:
        csv = target / f"{stem}-sweep.csv"
    if options["parquet"] is not None:
        parquet = target / f"{stem}-sweep.parquet"
    target.mkdir(parents=True, exist_ok=True)
    with writing(study, csv, parquet) as write_rows:
        swept = swept_again(study, path, keep=options["keep"], each=write_rows, watch=watch)
    files = [file for file in (csv, parquet) if file is not None]
    kinds = figures or (["parallel"] if swept.feasible else [])
    if kinds:
        files += draw_sweep(swept, kinds, show=show, out=target, stem=stem)
    return report_files(files)
