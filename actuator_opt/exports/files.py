"""Write an evaluation as files for other programs; if one of them fails, none is written."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from pathlib import Path

from ..base.dataclass import dataclass
from ..base.errors import Diagnostic, UsageError, library, shown
from ..base.files import write_all
from ..evaluation.result import Evaluation

FORMATS = ("step", "dxf", "xlsx")
"""Names of the formats, which are also the file suffixes."""

_NEEDS = {"dxf": "ezdxf", "xlsx": "openpyxl"}


@dataclass(frozen=True, slots=True)
class ExportFile:
    """A written file with its hash."""

    path: Path
    sha256: str

    def to_dict(self) -> dict[str, object]:
        """The JSON form."""
        return {"path": str(self.path), "sha256": self.sha256}


def require_formats(formats: Sequence[str]) -> tuple[str, ...]:
    """Drop duplicate formats; refuse unknown formats, and formats whose library is missing.

    Raises
    ------
    UsageError : if a format is unknown, or none is given
    ActuatorError : if the library of a format is not installed
    """
    if not formats:
        raise UsageError(Diagnostic("no format given", f"add --format {'|'.join(FORMATS)}"))
    for name in formats:
        if name not in FORMATS:
            remedy = f"use {', '.join(FORMATS)}, each with its own --format"
            raise UsageError(Diagnostic(f'unknown format "{shown(name)}"', remedy))
        if name in _NEEDS:
            library(_NEEDS[name])
    return tuple(dict.fromkeys(formats))


def _content(evaluation: Evaluation, name: str, date: str | None) -> bytes:
    program = f"actuator-opt {evaluation.version}"
    if name == "step":
        from .step import bodies, step

        text = step(bodies(evaluation), name=evaluation.name, program=program, date=date)
        return text.encode("ascii")
    if name == "dxf":
        from .dxf import dxf

        return dxf(evaluation, program=program, date=date)
    from .xlsx import xlsx

    return xlsx(evaluation, program=program, date=date)


def write_exports(
    evaluation: Evaluation,
    *,
    formats: Sequence[str],
    folder: Path,
    stem: str,
    date: str | None = None,
) -> list[ExportFile]:
    """Write ``STEM.FORMAT`` for every format into `folder`.

    Parameters
    ----------
    evaluation : evaluation of the design to export
    formats : some of `FORMATS`
    folder, stem : folder (created if missing) and file name without suffix
    date : ISO date in the files, or None

    Returns
    -------
    the files, in the order of `formats`

    Raises
    ------
    InputError : if a part cannot be drawn, or the folder is not writable; no file is written
    """
    names = require_formats(formats)
    contents = {f"{stem}.{name}": _content(evaluation, name, date) for name in names}
    write_all(folder, contents, what="the export")
    return [
        ExportFile(folder / name, hashlib.sha256(content).hexdigest())
        for name, content in contents.items()
    ]
