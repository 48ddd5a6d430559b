"""Files for other programs: parts as STEP, the section as DXF, results as XLSX, formulas as C.

The equations of a scenario are written as C, or as a unit by FMI 2.0 (FMU).

If one of the files fails, none is written.
"""

from __future__ import annotations

import hashlib
from collections.abc import Mapping, Sequence
from pathlib import Path

from ..base.dataclass import dataclass
from ..base.errors import Diagnostic, UsageError, library, shown
from ..base.files import write_all
from ..design.scenario.kinds import Records
from ..design.scenario.model import Scenario
from ..evaluation.kernel import PreparedDesign
from ..evaluation.result import Evaluation

FORMATS = ("step", "dxf", "xlsx", "c", "fmu")
"""Names of the formats, which are also the file suffixes; C has a header file too."""
SCENARIO_FORMATS = ("c", "fmu")
"""Formats of the equations of a scenario."""

_NEEDS = {"dxf": "ezdxf", "xlsx": "openpyxl"}


@dataclass(frozen=True, slots=True)
class ExportFile:
    """A written file with its hash."""

    path: Path
    sha256: str
    note: str = ""
    """Missing part of the file, with the reason."""

    def to_dict(self) -> dict[str, object]:
        """The JSON form."""
        note = {"note": self.note} if self.note else {}
        return {"path": str(self.path), "sha256": self.sha256, **note}


def require_formats(formats: Sequence[str], *, scenario: bool = False) -> tuple[str, ...]:
    """Drop duplicate formats; refuse unknown formats, and formats whose library is missing.

    Parameters
    ----------
    formats : names of formats
    scenario : whether the equations of a scenario are written, in `SCENARIO_FORMATS`

    Raises
    ------
    UsageError : if a format is unknown or does not fit, or none is given
    ActuatorError : if the library of a format is not installed
    """
    if not formats:
        raise UsageError(Diagnostic("no format given", f"add --format {'|'.join(FORMATS)}"))
    for name in formats:
        if name not in FORMATS:
            remedy = f"use {', '.join(FORMATS)}, each with its own --format"
            raise UsageError(Diagnostic(f'unknown format "{shown(name)}"', remedy))
        if scenario and name not in SCENARIO_FORMATS:
            message = f"the equations of a scenario have no {name.upper()} file"
            raise UsageError(Diagnostic(message, f"use --format {' or '.join(SCENARIO_FORMATS)}"))
        if name == "fmu" and not scenario:
            message = "an FMU file contains a circuit over time: it needs a scenario"
            remedy = "add --scenario FILE, or give a scenario that names its design"
            raise UsageError(Diagnostic(message, remedy))
        if name in _NEEDS:
            library(_NEEDS[name])
    return tuple(dict.fromkeys(formats))


def _files(
    evaluation: Evaluation, subject: PreparedDesign, name: str, stem: str, date: str | None
) -> dict[str, bytes]:
    """The files of a format, by file name."""
    program = f"actuator-opt {evaluation.version}"
    if name == "step":
        from .step import bodies, step

        text = step(bodies(evaluation), name=evaluation.name, program=program, date=date)
        return {f"{stem}.step": text.encode("ascii")}
    if name == "dxf":
        from .dxf import dxf

        return {f"{stem}.dxf": dxf(evaluation, program=program, date=date)}
    if name == "c":
        from .c_design import design_files

        return design_files(subject, stem=stem, program=program, date=date)
    from .xlsx import xlsx

    return {f"{stem}.xlsx": xlsx(evaluation, program=program, date=date)}


def write_exports(
    evaluation: Evaluation,
    subject: PreparedDesign,
    *,
    formats: Sequence[str],
    folder: Path,
    stem: str,
    date: str | None = None,
) -> list[ExportFile]:
    """Write ``STEM.FORMAT`` for every format into `folder`.

    Parameters
    ----------
    evaluation, subject : the design to export, evaluated and prepared
    formats : some of `FORMATS`
    folder, stem : folder (created if missing) and file name without suffix
    date : ISO date in the files, or None

    Returns
    -------
    the files, in the order of `formats`

    Raises
    ------
    InputError : if a part cannot be drawn, the design cannot be written as C, or the folder is not
        writable; no file is written
    """
    contents: dict[str, bytes] = {}
    for name in require_formats(formats):
        contents |= _files(evaluation, subject, name, stem, date)
    return written(folder, contents)


def scenario_exports(
    scenario: Scenario,
    subject: PreparedDesign,
    records: Records,
    *,
    formats: Sequence[str],
    folder: Path,
    stem: str,
    program: str,
    date: str | None = None,
) -> list[ExportFile]:
    """Write the equations of a scenario into `folder`.

    Parameters
    ----------
    scenario, records : inputs over time, and the columns of files that they name
    subject : the design, already with the values that the scenario sets
    formats : some of `SCENARIO_FORMATS`
    folder, stem : folder (created if missing) and file name without suffix
    program, date : origin of the files

    Raises
    ------
    InputError : if the equations cannot be written, or the folder is not writable; no file is
        written
    """
    contents: dict[str, bytes] = {}
    notes: dict[str, str] = {}
    for name in require_formats(formats, scenario=True):
        if name == "c":
            from .c_scenario import scenario_files

            contents |= scenario_files(
                scenario, subject, records, stem=stem, program=program, date=date
            )
        else:
            from .fmu import unit

            file, content, note = unit(
                scenario, subject, records, stem=stem, program=program, date=date
            )
            contents[file], notes[file] = content, note
    return written(folder, contents, notes)


def written(
    folder: Path, contents: Mapping[str, bytes], notes: Mapping[str, str] | None = None
) -> list[ExportFile]:
    """Write files by name into a folder; raises `InputError`, and then writes none."""
    write_all(folder, contents, what="the export")
    known = notes or {}
    return [
        ExportFile(folder / name, hashlib.sha256(content).hexdigest(), known.get(name, ""))
        for name, content in contents.items()
    ]
