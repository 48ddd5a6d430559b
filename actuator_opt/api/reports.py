"""Reports of designs, saving of designs, and the arguments that all reports have in common."""

from __future__ import annotations

import hashlib
import os
import re
from collections.abc import Iterable, Sequence
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Required, TypedDict, Unpack

from ..base.arguments import guarded
from ..base.errors import Diagnostic, UsageError, remedy, shown
from ..design import Design, FileSource
from ..evaluation import Evaluation, PreparedDesign, prepare
from ..evaluation.plugin import with_own
from ..metrics import METRICS
from .actuator import Actuator, as_actuator, stamped

if TYPE_CHECKING:
    from ..evaluation.rings import Place
    from ..optimisation.result import Optimisation
    from ..pages import ReportFile, Table
    from ..rendering.blocks import AttachedFile, Block, Origin
    from ..simulation import Simulation
    from ..simulation.verification import Verification
    from ..studies.seal import SealStudy

REPLICAS = "actuator_opt.replicas"
"""Package with the tables of published papers; it is imported by name, since a wheel lacks it."""
ABSENT = (
    "Caution: the tables that compare our numbers with {paper} are not part of this installation. "
    "The source distribution and the repository contain them, in actuator_opt/replicas."
)
FORMATS = ("pdf", "html", "both")
"""Formats of a report; "pdf" also writes PNG."""
_LAST_SECOND = 253_402_300_799
"""End of the year 9999, the latest date that can be written."""


def _seal_studies(subject: PreparedDesign) -> list[SealStudy]:
    """Study, for a report, the piston and rod seals whose friction follows from an oil film."""
    from ..studies.seal import study

    if not any(case.moves for case in subject.design.load_cases):
        return []
    places: tuple[Place, ...] = ("piston", "rod")
    films = [x for x in places if getattr(subject.design.seals, x).friction_law.film]
    return [study(subject, place, curves=True, mapped=True) for place in films]


class ReportArguments(TypedDict, total=False):
    """Arguments that all reports have in common; see `report`."""

    folder: str | Path
    stem: str | None
    actuator: Actuator | None
    command: str
    date: str | None
    all_pages: bool
    format: str


class ReportPlace(TypedDict, total=False):
    """Folder and file name (without suffix) of a page, and which of its files to write."""

    folder: Required[Path]
    stem: Required[str]
    all_pages: bool
    format: str


def page_of(
    design: Design,
    tail: str = "",
    *,
    beside: str | None = None,
    folder: str | Path = "reports",
    stem: str | None = None,
    actuator: Actuator | None = None,
    command: str = "",
    date: str | None = None,
    all_pages: bool = False,
    format: str = "pdf",
) -> tuple[Origin, ReportPlace]:
    """The title block of a page, and where the page is written.

    Parameters
    ----------
    design : design that the page shows
    tail : text added to the name of the design's file
    beside : file whose name is used instead of the design file's
    folder, stem, actuator, command, date, all_pages, format : as for `report`

    Raises
    ------
    UsageError : the date is not an ISO date, or the format is unknown
    """
    require_format(format)
    if date is not None:
        require_date(date)
    source = None if actuator is None else actuator.source
    default = f"{Path(beside or file_name(design, source)).stem}{tail}"
    page = origin(design, source, command=command, date=date)
    place: ReportPlace = {"folder": Path(folder), "stem": stem or default}
    if all_pages:
        place["all_pages"] = True
    if format != "pdf":
        place["format"] = format
    return page, place


def require_format(format: str, option: str = "format") -> None:
    """Reject an unknown format of a report; raises `UsageError`."""
    if format not in FORMATS:
        message = f'{option} "{shown(format)}" is not a format of reports'
        raise UsageError(Diagnostic(message, remedy(format, FORMATS)))


def report_design(
    subject: Evaluation | Optimisation,
    *,
    extra_tables: Sequence[Table] = (),
    dynamics_verified: Verification | None = None,
    attached: Sequence[AttachedFile] = (),
    **paper: Unpack[ReportArguments],
) -> list[ReportFile]:
    """Write the report of an evaluation or an optimisation; parameters as for `report`."""
    from ..pages.report import outcome, page
    from ..rendering.paper import write

    evaluation = subject if isinstance(subject, Evaluation) else subject.best_evaluation
    design = subject.design if isinstance(subject, Evaluation) else subject.best
    origin, place = page_of(design, **paper)
    tables = [*published(evaluation), *extra_tables, *verification_tables(dynamics_verified)]
    seals = _seal_studies(prepare(design))
    report = page(subject, extra_tables=tables, seals=seals, attached=attached)
    run = {"actuator_opt": evaluation.version, "result": outcome(subject)}
    return write(report, origin, **place, attached=attached, **run)


def published(subject: Evaluation | Simulation) -> list[Block]:
    """Tables that compare our numbers with those of the source that design or scenario reproduces.

    The package with these tables is imported by name, because a wheel lacks it. If it is missing,
    the report says which distributions contain the tables.
    """
    from ..rendering.blocks import Notes

    holder = subject.design if isinstance(subject, Evaluation) else subject.scenario
    if holder.reproduces is None:
        return []
    try:
        replicas = import_module(REPLICAS)
    except ModuleNotFoundError as error:
        if error.name != REPLICAS:
            raise
        return [Notes("Published numbers", [ABSENT.format(paper=holder.reproduces)])]
    blocks: list[Block] = replicas.published(subject)
    return blocks


def verification_tables(verification: Verification | None) -> list[Table]:
    """Requirements that a simulation verified, as tables of a report."""
    if verification is None:
        return []
    from ..pages.verification import tables

    return [*tables(verification)]


def report_files(paths: Iterable[Path]) -> list[ReportFile]:
    """Files that have been written, each with its hash."""
    from ..pages import ReportFile

    return [ReportFile(path, hashlib.sha256(path.read_bytes()).hexdigest(), 1) for path in paths]


def file_name(design: Design, source: FileSource | None) -> str:
    """Name of the design's file; if it has no file, a name made from the design's name."""
    if source is not None and not source.file.startswith("<"):
        return Path(source.file).name
    name = re.sub(r"[^\w-]+", "_", design.name).strip("_")
    return f"{name or 'design'}.yaml"


def origin(
    design: Design, source: FileSource | None, *, command: str = "", date: str | None = None
) -> Origin:
    """The origin stated on a page: the file as read, or else the design's text."""
    from ..design.data_file import texts_of
    from ..design.writer import to_yaml
    from ..evaluation.build import spec_hash
    from ..rendering.blocks import Origin

    return Origin(
        source_text=to_yaml(design) if source is None else source.text,
        source_name=file_name(design, source),
        command=command,
        spec_hash=spec_hash(prepare(design)),
        date=date or date_from_environment(),
        files=texts_of(design),
    )


def is_date(text: str) -> bool:
    """Whether a text is an ISO date.

    >>> is_date("2026-02-28"), is_date("2026-02-30"), is_date("20260228")
    (True, False, False)
    """
    from datetime import date

    try:
        return date.fromisoformat(text).isoformat() == text
    except ValueError:
        return False


def require_date(text: str, option: str = "date") -> None:
    """Reject a text that is not an ISO date; raises `UsageError`."""
    if not is_date(text):
        raise UsageError(Diagnostic(f'{option} "{text}" is not a date', "write YYYY-MM-DD"))


def date_from_environment() -> str | None:
    """The date (UTC) of SOURCE_DATE_EPOCH, or None if that is not set.

    Raises
    ------
    UsageError : it is not a count of seconds
    """
    stamp = os.environ.get("SOURCE_DATE_EPOCH", "").strip()
    if not stamp:
        return None
    digits = stamp.isdecimal() and stamp.isascii() and len(stamp) <= 12
    if not digits or int(stamp) > _LAST_SECOND:
        message = f'SOURCE_DATE_EPOCH "{stamp[:40]}" is not a count of seconds since 1970'
        raise UsageError(Diagnostic(message, "write e.g. 1700000000, or unset it"))
    from datetime import UTC, datetime

    return datetime.fromtimestamp(int(stamp), UTC).date().isoformat()


@guarded
def save(
    design: Actuator | Design | Evaluation | Optimisation | str | Path,
    path: str | Path,
    *,
    source: FileSource | None = None,
) -> Path:
    """Write a design file with full precision; comments and order are kept if possible.

    Names of data files become relative to the folder of the new file.

    For an optimisation, the design to build is written, and the first line marks the file as an
    optimum. This mark is omitted for a design with custom metrics, which may change independently
    of the file.
    """
    from ..base.files import write_text

    return write_text(Path(path), saved_text(design, Path(path).parent, source))


def saved_text(
    design: Actuator | Design | Evaluation | Optimisation | str | Path,
    folder: Path,
    source: FileSource | None = None,
) -> str:
    """The text that `save` writes to a file in this folder."""
    from ..design.data_file import moved
    from ..design.writer import to_yaml
    from ..optimisation.result import Optimisation

    metrics = None if source is None else source.metrics
    if isinstance(design, Optimisation):
        text = to_yaml(moved(design.best, folder), source, metrics=metrics)
        if design.optimum and design.best_evaluation.metrics.keys() <= METRICS.keys():
            text = stamped(text, design.best_evaluation.spec_hash)
        return text
    if isinstance(design, str | Path):
        design = as_actuator(design)
    elif isinstance(design, Evaluation):
        design = design.design
    if isinstance(design, Actuator):
        source = source or design.source
        metrics = with_own(design.plugins)
        design = design.design
    return to_yaml(moved(design, folder), source, metrics=metrics)
