"""Exports a design to files for other programs."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from ..base import files, runs as run_store
from ..base.arguments import guarded
from ..base.errors import Diagnostic, InputError, UsageError
from ..design import Design, is_scenario
from ..evaluation import Evaluation
from ..version import VERSION
from .actuator import Actuator, Plugins, as_actuator, located, plugins_of
from .optimum import evaluate
from .recorded_runs import Run, damage_reported, read_run
from .reports import date_from_environment, file_name, require_date
from .restoring import changed_plugins, named_plugins, restore
from .simulations import Trial, as_trial, placed, with_design
from .sweeping import store_of, without_variables

if TYPE_CHECKING:
    from ..explorer import ExplorerFile
    from ..exports import ExportFile
    from ..optimisation.result import Optimisation
    from ..sweeps.explored import Explored


@guarded
def export(
    subject: Actuator | Design | Evaluation | Optimisation | Trial | str | Path,
    *,
    formats: Sequence[str] = ("step",),
    folder: str | Path = "reports",
    stem: str | None = None,
    actuator: Actuator | None = None,
    date: str | None = None,
    plugins: Plugins = (),
    scenario: Trial | str | Path | None = None,
) -> list[ExportFile]:
    """Write a design as STEP, DXF, XLSX or C files, or a scenario with it as C or FMU.

    STEP contains the turned parts as solids, in mm, positioned as in the section drawing of the
    retracted actuator; their volumes agree with the mass breakdown. It lacks parts whose shape the
    models do not define: threads, studs and plugs of the rod, eyes, seals and guides, ports, and
    the holes for tie rods in the plates. DXF contains the section with true dimensions and one
    layer per part. XLSX contains the requirements with margins as live formulas, the section as a
    picture, the variables and the masses. C contains metrics, limits and their gradients as a
    function of the variables and other numbers, in a source file and a header.

    Parameters
    ----------
    subject : a design in any form, an evaluation, an optimisation (its best design), or a scenario
        (its file or as read), which then is written with the design that it names
    formats : any of "step", "dxf" (both need the extra ``cad``), "xlsx" (extra ``excel``), "c"; for
        a scenario "c" and "fmu"
    folder, stem : folder and name of the files; default: the design's name in ``reports/``
    actuator : the design as read, if `subject` is its evaluation; exports are named after its file
    date : ISO date in the files; default: that of SOURCE_DATE_EPOCH, or else none
    plugins : the user's metrics and constraints, for a design that is not an `Actuator` yet
    scenario : write the equations of this scenario instead, with the given design in it, named
        after the scenario's file: as C, or as a unit by FMI 2.0 ("fmu"). A unit contains a
        library for this platform if there is a C compiler; else its `ExportFile.note` says so

    Returns
    -------
    the files, each with its path and SHA-256

    Raises
    ------
    UsageError : an unknown format, a format without scenarios, or a date that is not an ISO date
    InputError : a part cannot be drawn, the design cannot be written as C, or the folder cannot be
        written
    ActuatorError : the extra that the format needs is not installed
    """
    from ..exports import require_formats, write_exports

    if date is not None:
        require_date(date)
    formats = (formats,) if isinstance(formats, str) else formats
    if scenario is not None and isinstance(subject, Trial):
        raise UsageError(Diagnostic("two scenarios are given", "leave out `scenario`"))
    trial = subject if isinstance(subject, Trial) else None
    if scenario is None and isinstance(subject, str | Path):
        trial = as_trial(subject) if is_exported_scenario(subject, formats) else None
    formats = require_formats(formats, scenario=scenario is not None or trial is not None)
    date = date or date_from_environment()
    if trial is not None:
        return _export_scenario(
            trial, trial.actuator, formats=formats, folder=Path(folder), stem=stem, date=date
        )
    assert not isinstance(subject, Trial)  # it has returned above
    if isinstance(subject, Actuator | Design | str | Path):
        exported = as_actuator(subject, plugins)
        evaluation = None
    else:
        evaluation = subject if isinstance(subject, Evaluation) else subject.best_evaluation
        own = plugins_of(plugins) if actuator is None else actuator.plugins
        exported = Actuator(evaluation.design, None if actuator is None else actuator.source, own)
    if scenario is not None:
        trial = as_trial(scenario)
        return _export_scenario(
            trial, with_design(trial, exported), formats=formats, folder=Path(folder), stem=stem,
            date=date,
        )  # fmt: skip
    with located(exported):
        return write_exports(
            evaluation or evaluate(exported),
            exported.subject(),
            formats=formats,
            folder=Path(folder),
            stem=stem or Path(file_name(exported.design, exported.source)).stem,
            date=date,
        )


def is_exported_scenario(source: str | Path, formats: Sequence[str]) -> bool:
    """Whether a file to export is a scenario: by its keys, or for standard input by the formats."""
    return "fmu" in formats if str(source) == "-" else is_scenario(source)


def _export_scenario(
    trial: Trial, actuator: Actuator, *, formats: Sequence[str], folder: Path, stem: str | None,
    date: str | None,
) -> list[ExportFile]:  # fmt: skip
    """Write the equations of a scenario with a design that has the scenario's values."""
    from ..exports import scenario_exports

    file = trial.loaded.source.file
    with placed(trial):
        inputs, records = trial.inputs(actuator)
        return scenario_exports(
            inputs, actuator.subject(), records,
            formats=formats, folder=folder,
            stem=stem or ("scenario" if file.startswith("<") else Path(file).stem),
            program=f"actuator-opt {VERSION}", date=date,
        )  # fmt: skip


ROWS = 5000
"""Largest number of designs on a page; of a larger set, an even sample is shown."""


@guarded
def explore(
    store: str | Path,
    *,
    out: str | Path = "reports",
    study: int | None = None,
    rows: int = ROWS,
    plugins: Sequence[str | Path] = (),
) -> list[ExplorerFile]:
    """Write an interactive page of a stored sweep or Pareto front, and a file of its base design.

    Parameters
    ----------
    store : database written by `sweep`, or a recorded run of `sweep` or `pareto`, named as for
        `read_run`
    out : the page's file (``.html``), or a folder
    study : number of the study (a base design with its varied inputs) in the database; default:
        that of the run, or else the newest
    rows : maximum number of designs shown; of a larger sweep, an even sample and the best designs
    plugins : files with the user's metrics and constraints, the same as for the sweep. The record
        names these files, but they only run if given here

    Returns
    -------
    the files of the page and the design, each with its hash

    Raises
    ------
    UsageError
        `rows` is less than 1
    InputError
        the file, study or run does not exist; the file is not a sweep's database, or has moved; the
        sweep used other models, materials or custom metrics; or the page cannot be written
    """
    from ..explorer import write_explorer
    from ..sweeps.explored import explored

    if rows < 1:
        raise UsageError(Diagnostic(f"--rows {rows}", "give 1 or more"))
    if str(out) == "-":
        raise UsageError(Diagnostic("--out -: the page cannot be printed as text", "name a file"))
    run = read_run(store) if run_store.is_name(str(store)) else None
    if run is not None and study is not None:
        raise UsageError(Diagnostic("--study: a run has only one study", "leave it out"))
    front = run is not None and run.head.get("kind") == "pareto"
    study_key: int | str | None = study
    source, target = Path(store), Path(out)
    loaded_plugins, remarks = plugins_of(plugins), list[str]()
    if run is not None:
        with damage_reported(run):
            source, study_key = (run.path, None) if front else store_of(run)
            remarks = changed_plugins(run, named_plugins(run, loaded_plugins))
    if target.suffix.lower() not in (".html", ".htm"):
        stem = f"{Path(str(run.head.get('file'))).stem}_pareto" if run and front else source.stem
        target = target / f"{stem}_explore.html"
    _require(target, source)
    if run is not None and front:
        with damage_reported(run):
            explored_rows = _front(run, loaded_plugins)
    else:
        explored_rows = explored(source, study=study_key, most=rows, plugins=loaded_plugins)
    with files.writing(target.parent):
        target.parent.mkdir(parents=True, exist_ok=True)
    paths = [os.path.relpath(Path(file).resolve(), target.parent.resolve()) for file in plugins]
    return write_explorer(explored_rows, target, plugins=paths, remarks=remarks)


def _require(target: Path, source: Path) -> None:
    """Reject an output file that cannot be written, or that is the source itself."""
    from ..explorer import design_beside

    files.require_folder(target.parent)
    for path in (target, design_beside(target)):
        files.require_apart(path, str(source))


def _front(run: Run, plugins: Plugins) -> Explored:
    """The designs of a recorded Pareto front."""
    from ..optimisation.pareto import ParetoFront
    from ..sweeps.explored import explored_designs

    restored = restore(run, plugins=plugins)
    front = restored.result
    assert isinstance(front, ParetoFront)
    if not front.points:
        raise InputError(Diagnostic(front.sentence, "see: runs show", str(run.path)))
    return explored_designs(
        without_variables(restored.actuator),
        [point.variables for point in front.points],
        plugins=restored.actuator.plugins,
        origin="Pareto front",
        shown=tuple(objective.metric for objective in front.objectives),
    )
