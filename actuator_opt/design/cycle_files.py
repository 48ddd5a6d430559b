"""Files of duty cycles that a design names: read once, and kept with the design.

The value of ``duty.cycles[NAME].file`` is a text: the name of a file, relative to the folder of the
design, or the text of the file itself, of several lines. Once read, this value is a `CycleFile`:
the same text, with the content of the file. It stays with the design through all changes, so that a
design needs its files only once.
"""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from ..base.errors import shown
from .cycle_record import MOST_BYTES, CycleRecord, parse_cycle
from .kinds import FileName, ValueFault

_NAMED = "# file: "
"""First line of a cycle's text inside a design file, with the name of its file."""


class CycleFile(str):
    """Name of a cycle's file, or its text as written in the design, with the file's content.

    Two cycle files are equal if their names and their contents are; a plain text is equal to the
    name.
    """

    text: str
    folder: str
    _records: dict[tuple[object, ...], CycleRecord]

    def __new__(cls, written: str, text: str, folder: str = "") -> CycleFile:
        """Join a name as written, the content, and the folder to which the name is relative."""
        new = super().__new__(cls, written)
        new.text, new.folder, new._records = text, folder, {}
        return new

    def __reduce__(self) -> tuple[type[CycleFile], tuple[str, str, str]]:
        return CycleFile, (str.__str__(self), self.text, self.folder)

    def __eq__(self, other: object) -> bool:
        if isinstance(other, CycleFile) and self.text != other.text:
            return False
        return str.__eq__(self, other) if isinstance(other, str) else NotImplemented

    def __ne__(self, other: object) -> bool:
        return not self == other

    def __hash__(self) -> int:
        return str.__hash__(self)

    @property
    def inside(self) -> bool:
        """Whether the design file itself has the text of the cycle."""
        return "\n" in self

    @property
    def label(self) -> str:
        """Name of the file, also if the design file has its text."""
        if not self.inside:
            return str.__str__(self)
        first = self.partition("\n")[0].strip()
        named = first.startswith(_NAMED)
        return shown(first.removeprefix(_NAMED)) if named else "text of the cycle"

    @property
    def place(self) -> str:
        """The file's name with its folder, for messages."""
        return self.label if self.inside else str(Path(self.folder) / self)

    def record(
        self, *, closed: bool, ignore: Sequence[str] = (), samples: int | None = None
    ) -> CycleRecord:
        """The record, parsed once per setting; faults as for `read_cycle`."""
        key = (closed, tuple(ignore), samples)
        if key not in self._records:
            basic = self._records.get((closed, tuple(ignore), None))
            if basic is None:
                basic = parse_cycle(self.text, self.place, closed=closed, ignore=ignore)
                self._records[closed, tuple(ignore), None] = basic
            self._records[key] = basic if samples is None else basic.resampled(samples)
        return self._records[key]

    def portable(self) -> CycleFile:
        """The same cycle as the text itself, so that a design needs no second file."""
        if self.inside:
            return self
        text = self.text if self.text.endswith("\n") else f"{self.text}\n"
        return CycleFile(f"{_NAMED}{self}\n{text}", self.text, self.folder)

    def moved(self, folder: Path) -> CycleFile:
        """The name relative to another folder; absolute names and texts stay."""
        own = Path(self.folder)
        if self.inside or Path(self).is_absolute() or own.resolve() == folder.resolve():
            return self
        try:
            name = os.path.relpath(own.resolve() / self, folder.resolve())
        except ValueError:  # on another drive of Windows
            name = str(own.resolve() / self)
        return CycleFile(Path(name).as_posix(), self.text, str(folder))


class CycleFileName(FileName):
    """Name of a cycle's file, or its text of several lines."""

    def validate(self, value: Any) -> str:
        """The name or text; a `CycleFile` stays one."""
        if isinstance(value, CycleFile):
            return value
        if isinstance(value, str) and "\n" in value:
            if len(value) > MOST_BYTES:
                message = f"the text of the cycle is larger than {MOST_BYTES / 1e6:.0f} MB"
                raise ValueFault(message, "resample the cycle")
            return value
        return super().validate(value)
