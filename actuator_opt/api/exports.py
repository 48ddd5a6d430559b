"""Exports of a design to other programs."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from ..design import Design
from ..evaluation import Evaluation
from .actuator import Actuator, Plugins, as_actuator
from .optimum import evaluate
from .reports import date_from_environment, file_name, require_date

if TYPE_CHECKING:
    from ..exports import ExportFile
    from ..optimisation.result import Optimisation


def export(
    subject: Actuator | Design | Evaluation | Optimisation | str | Path,
    *,
    formats: Sequence[str] = ("step",),
    folder: str | Path = "reports",
    stem: str | None = None,
    actuator: Actuator | None = None,
    date: str | None = None,
    plugins: Plugins = (),
) -> list[ExportFile]:
    """Write a design as STEP, DXF or XLSX files.

    STEP holds the turned parts as solids, in mm, placed as in the section drawing, retracted;
    their volumes are those of the mass breakdown. Not in it, for the models know no shape of
    theirs: threads, studs and plugs of the rod, eyes, seals and guides, ports, and the holes of tie
    rods in the plates. DXF is the section with true dimensions, layers by part; XLSX has the
    requirements with live margins, the section as a picture, the variables and the masses.

    Parameters
    ----------
    subject : a design in any form, an evaluation, or an optimisation (its best design)
    formats : one or more of "step", "dxf" (extra ``cad``), "xlsx" (extra ``excel``)
    folder, stem : target; default: the design's name in ``reports/``
    actuator : the design as read, if `subject` is its evaluation: the files get its file's name
    date : ISO date in the files; default: SOURCE_DATE_EPOCH, else none
    plugins : the user's metrics and constraints, for a design that is not an `Actuator` yet

    Returns
    -------
    the files, each with its path and SHA-256

    Raises
    ------
    UsageError : no such format, or not an ISO date
    InputError : a part cannot be drawn, or the folder cannot be written
    ActuatorError : the format's extra is not installed
    """
    from ..exports import require_formats, write_exports

    if date is not None:
        require_date(date)
    formats = require_formats((formats,) if isinstance(formats, str) else formats)
    if isinstance(subject, Actuator | Design | str | Path):
        actuator = as_actuator(subject, plugins)
        evaluation = evaluate(actuator)
    else:
        evaluation = subject if isinstance(subject, Evaluation) else subject.best_evaluation
    source = None if actuator is None else actuator.source
    return write_exports(
        evaluation,
        formats=formats,
        folder=Path(folder),
        stem=stem or Path(file_name(evaluation.design, source)).stem,
        date=date or date_from_environment(),
    )
