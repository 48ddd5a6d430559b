"""Data files that a design names: read once, and kept with the design.

The value of such a key is a text: the name of a file, relative to the folder of the design, or the
text of the file itself, of several lines. Once read, this value is a `DataFile`: the same text,
with the content of the file. It stays with the design through all changes, so that a design needs
its files only once.

A key becomes a data file by its kind, `DataFileName`, which states what may be read and how it is
parsed. Reading, PATHs, reports, run records and messages follow from that.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, Concatenate, ParamSpec, Protocol, TypeVar, cast

from ..base.errors import Diagnostic, InputError, shown
from ..base.sheets import read_text
from .kinds import FileName, Section, ValueFault

_NAMED = "# file: "
"""First line of a file's text inside a design file, with the name of the file."""
_INSIDE = "text in the design"
"""Label of a text without the name of its file."""
Settings = ParamSpec("Settings")
Parsed = TypeVar("Parsed")
Block = TypeVar("Block", bound=Section)


class DataFile(str):
    """Name of a file, or its text as written in the design, with the file's content.

    Two data files are equal if their names and their contents are; a plain text is equal to the
    name.
    """

    text: str
    folder: str
    _parsed: dict[object, Any]

    def __new__(cls, written: str, text: str, folder: str = "") -> DataFile:
        """Join a name as written, the content, and the folder to which the name is relative."""
        new = super().__new__(cls, written)
        new.text, new.folder, new._parsed = text, folder, {}
        return new

    def __reduce__(self) -> tuple[type[DataFile], tuple[str, str, str]]:
        return DataFile, (str.__str__(self), self.text, self.folder)

    def __eq__(self, other: object) -> bool:
        if isinstance(other, DataFile) and self.text != other.text:
            return False
        return str.__eq__(self, other) if isinstance(other, str) else NotImplemented

    def __ne__(self, other: object) -> bool:
        return not self == other

    def __hash__(self) -> int:
        return str.__hash__(self)

    @property
    def inside(self) -> bool:
        """Whether the design file itself has the text of the file."""
        return "\n" in self

    @property
    def label(self) -> str:
        """Name of the file, also if the design file has its text."""
        if not self.inside:
            return str.__str__(self)
        first = self.partition("\n")[0].strip()
        return shown(first.removeprefix(_NAMED)) if first.startswith(_NAMED) else _INSIDE

    @property
    def place(self) -> str:
        """The file's name with its folder, for messages."""
        return self.label if self.inside else str(Path(self.folder) / self)

    def parsed(
        self,
        parse: Callable[Concatenate[DataFile, Settings], Parsed],
        *args: Settings.args,
        **settings: Settings.kwargs,
    ) -> Parsed:
        """Result of a function of this file, computed once for the same settings."""
        key = (parse, args, tuple(sorted(settings.items())))
        if key not in self._parsed:
            self._parsed[key] = parse(self, *args, **settings)
        result: Parsed = self._parsed[key]
        return result

    def portable(self) -> DataFile:
        """The same file as the text itself, so that a design needs no second file."""
        if self.inside:
            return self
        text = self.text if self.text.endswith("\n") else f"{self.text}\n"
        return DataFile(f"{_NAMED}{self}\n{text}", self.text, self.folder)

    def moved(self, folder: Path) -> DataFile:
        """The name relative to another folder; absolute names and texts stay."""
        own = Path(self.folder)
        if self.inside or Path(self).is_absolute() or own.resolve() == folder.resolve():
            return self
        try:
            name = os.path.relpath(own.resolve() / self, folder.resolve())
        except ValueError:  # on another drive of Windows
            name = str(own.resolve() / self)
        return DataFile(Path(name).as_posix(), self.text, str(folder))


class Content(Protocol):
    """Parsed content of a data file."""

    @property
    def digest(self) -> str:
        """SHA-256 of the numbers, by which hashes of designs count them."""


class DataFileName(FileName):
    """Name of a CSV file that is read with the design, or its text of several lines.

    Parameters
    ----------
    help, example : meaning of the key, and a name of a file
    most : largest size of the file [bytes]
    parse : function that reads the content, given the file and the block of its key, whose values
        may still be texts; it raises `InputError`
    """

    def __init__(
        self,
        help: str,
        example: str,
        *,
        most: int,
        parse: Callable[[DataFile, Mapping[str, Any]], Content],
    ) -> None:
        super().__init__(help, example)
        self.longest = most
        self.parse = parse

    def validate(self, value: Any) -> str:
        """The name or text; a `DataFile` stays one."""
        if isinstance(value, DataFile):
            return value
        if isinstance(value, str) and "\n" in value:
            if len(value) > self.longest:
                message = f"the text has more than {self.longest} characters"
                raise ValueFault(message, "leave out unneeded columns and digits")
            return value
        return super().validate(value)

    def read(self, written: str, folder: Path) -> DataFile:
        """Read the file of this name in a folder, or take the text itself.

        Raises
        ------
        ValueFault, InputError
            an unsuitable name, an unreadable file
        """
        written = written if "\n" in written else written.strip()
        self.validate(written)
        inside = "\n" in written
        text = written if inside else read_text(folder / written, most=self.longest)
        return DataFile(written, text, str(folder))


def as_read(value: str, what: str) -> DataFile:
    """The value of a key as a data file; raises `InputError` if its file was not read."""
    if not isinstance(value, DataFile) and "\n" in value:  # the text itself
        return DataFile(value, value)
    if not isinstance(value, DataFile):
        message = f"{what}: its file was not read"
        raise InputError(Diagnostic(message, "read the design from its file"))
    return value


def texts_of(section: Section) -> dict[str, str]:
    """Contents of the data files that a design names, by name; see `reader.read_design`."""
    texts: dict[str, str] = {}

    def keep(file: DataFile) -> DataFile:
        if not file.inside:
            texts[str(file)] = file.text
        return file

    _with_files(section, keep)
    return texts


def moved(section: Block, folder: Path) -> Block:
    """The design with names of data files relative to another folder, where it will be written."""
    return cast(Block, _with_files(section, lambda file: file.moved(folder)))


def portable(section: Block) -> Block:
    """The design with the texts of its data files in place of names, so that it is complete."""
    return cast(Block, _with_files(section, lambda file: file.portable()))


def _with_files(node: object, change: Callable[[DataFile], DataFile]) -> object:
    """A block, list or value with all its data files changed; the same object if none changes."""
    if isinstance(node, DataFile):
        return change(node)
    if isinstance(node, tuple):
        items = tuple(_with_files(item, change) for item in node)
        return items if any(new is not old for new, old in zip(items, node, strict=True)) else node
    if not isinstance(node, Section):
        return node
    update = {name: _with_files(value, change) for name, value in node}
    update = {name: new for name, new in update.items() if new is not getattr(node, name)}
    return node.model_copy(update=update) if update else node
