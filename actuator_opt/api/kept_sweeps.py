"""A recorded sweep: location of its rows, and its figures and CSV from them."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Unpack

from ..base.errors import Diagnostic, InputError, UsageError
from ..base.tables import Displayed
from .actuator import Actuator
from .recorded_runs import Run
from .reports import Paper, file_name, report_files
from .sweeping import LARGE, draw_sweep, study_of, writing

if TYPE_CHECKING:
    from ..pages import ReportFile
    from ..sweeps.chunk import Study
    from ..sweeps.plan import Plan


@dataclass(frozen=True, slots=True)
class KeptSweep(Displayed):
    """A sweep from its record: the study, and the run with the location of its rows."""

    run: Run
    study: Study


def kept_sweep(run: Run, actuator: Actuator) -> KeptSweep:
    """The sweep of a record, without reading its rows yet."""
    asked = run.body["asked"]
    study = study_of(actuator, _plan(run), full=not asked["reduce"], show=asked["show"])
    return KeptSweep(run, study)


def _plan(run: Run) -> Plan:
    import numpy as np

    from ..sweeps.plan import Axis, plan

    told: dict[str, Any] = run.body["plan"]
    axes = [
        Axis(
            one["path"],
            None if one["values"] is None else np.array(one["values"], dtype=float),
            tuple(one["texts"]),
            one["range"],
            one["steps"],
        )
        for one in told["axes"]
    ]
    for axis in axes:
        ends = axis.range and axis.values is not None and len(axis.values) == 2
        steps = axis.count is None or axis.count >= 2
        if not (ends and steps if axis.range else axis.size):
            raise ValueError("an axis without values")
    count = None if told["method"] == "grid" else told["count"]
    try:
        found = plan(axes, method=told["method"], count=count, seed=run.head["seed"])
    except UsageError as error:
        raise ValueError(str(error)) from None
    if found.count != told["count"]:
        raise ValueError("another number of points")
    return found


def store_of(run: Run) -> tuple[Path, str]:
    """The database of a sweep's rows, and the hash of its study there.

    Raises
    ------
    InputError : the sweep has no store, or the file has moved
    """
    if run.head.get("kind") != "sweep":
        message = f"is a run of {run.head.get('kind')}, which has no stored rows"
        raise InputError(Diagnostic(message, "name a run of sweep or pareto", str(run.path)))
    kept = run.body["asked"]["store"]
    if kept is None:
        message = f"run {run.id} is a sweep without --store, so its rows were not stored"
        remedy = "see its best with runs show, or run it again with --store F.db"
        raise InputError(Diagnostic(message, remedy, str(run.path)))
    path = Path(kept["path"])
    if not path.exists():
        message = f"no longer exists; run {run.id} stored its rows there"
        remedy = "restore it, or name its new location: actuator-opt explore F.db"
        raise InputError(Diagnostic(message, remedy, str(path)))
    return path, kept["study"]


def report_sweep(kept: KeptSweep, **paper: Unpack[Paper]) -> list[ReportFile]:
    """Write the figures and tables of a recorded sweep again, from the rows in its store.

    The figures are those of the sweep, else parallel axes if a design is feasible. The CSV
    (``NAME-sweep.csv``) is omitted for a sweep of over a million points that wrote none; a Parquet
    file is written if the sweep wrote one. Of `paper` (see `report`) only folder and stem are used.

    Raises
    ------
    InputError : the store is missing, has other rows or lacks some, or the folder cannot be written
    """
    from ..base.files import require_folder
    from ..pages.sweep_figures.shared import watched
    from ..sweeps import swept_again

    target = Path(paper.get("folder", "reports"))
    asked, study = kept.run.body["asked"], kept.study
    path, _ = store_of(kept.run)
    require_folder(target)
    figures, show = asked["figures"], asked["show"]
    how: dict[str, Any] = {"keep": asked["keep"], "watch": watched(study, figures, show)}
    stem = paper.get("stem") or Path(file_name(study.design, None)).stem
    csv = parquet = None
    if study.plan.count <= LARGE or asked["csv"] is not None:
        csv = target / f"{stem}-sweep.csv"
    if asked["parquet"] is not None:
        parquet = target / f"{stem}-sweep.parquet"
    target.mkdir(parents=True, exist_ok=True)
    with writing(study, csv, parquet) as each:
        found = swept_again(study, path, each=each, **how)
    files = [file for file in (csv, parquet) if file is not None]
    kinds = figures or (["parallel"] if found.feasible else [])
    if kinds:
        files += draw_sweep(found, kinds, show=show, out=target, stem=stem)
    return report_files(files)
