"""Read the data files that a design or scenario names into its tree."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any

from ..base.errors import Diagnostic, Fault, InputError, shown
from .data_file import DataFile, DataFileName, as_read
from .kinds import Section, ValueFault
from .model import Design
from .structure import Loc, child_at, entries


@cache
def _keys(root: type[Section]) -> tuple[tuple[tuple[str | None, ...], DataFileName], ...]:
    """Locations of all keys in a file that name data files; None represents an index."""
    keys: list[tuple[tuple[str | None, ...], DataFileName]] = []
    for name, entry in entries(root).items():
        if isinstance(entry.kind, DataFileName):
            keys.append(((name,), entry.kind))
        elif entry.section is not None and entry.shape in ("section", "list"):
            head = (name,) if entry.shape == "section" else (name, None)
            keys += [((*head, *loc), kind) for loc, kind in _keys(entry.section)]
    return tuple(keys)


def _files(node: Any, root: type[Section]) -> Iterator[tuple[Loc, DataFileName, str]]:
    """All stated names of data files in a section or its tree: location, kind and value."""
    for key, kind in _keys(root):
        for loc in _places(node, key):
            value = child_at(node, loc)
            if isinstance(value, str):
                yield loc, kind, value


def _places(node: Any, key: tuple[str | None, ...]) -> Iterator[Loc]:
    """All locations of a key inside blocks and lists."""
    if None not in key:
        yield tuple(name for name in key if name is not None)
        return
    at = key.index(None)
    head: Loc = tuple(name for name in key[:at] if name is not None)
    items = child_at(node, head)
    for index, item in enumerate(items if isinstance(items, (list, tuple)) else ()):
        for rest in _places(item, key[at + 1 :]):
            yield (*head, index, *rest)


def attach(
    tree: Any,
    folder: Path,
    known: dict[str, DataFile] | None = None,
    root: type[Section] = Design,
) -> Iterator[Fault | Diagnostic]:
    """Read all data files that a tree names, and put their contents into the tree.

    Parameters
    ----------
    tree : tree of dicts and lists of a design or scenario; values that name files are replaced
    folder : folder to which the names are relative
    known : files that are read already, by name; new ones are added
    root : class of the whole file

    Yields
    ------
    a fault for every file as a whole, and a diagnostic for every fault at a line of a file
    """
    known = {} if known is None else known
    for loc, kind, written in _files(tree, root):
        block, file = child_at(tree, loc[:-1]), known.get(written.strip())
        try:
            if isinstance(written, DataFile):
                file = written
            elif file is None:
                file = known[written.strip()] = kind.read(written, folder)
            block[loc[-1]] = file
            kind.parse(file, block)
        except ValueFault:  # an unsuitable name is a fault of its own
            continue
        except InputError as error:
            for fault in error.diagnostics:
                if fault.line is not None:
                    yield fault
                else:
                    where = fault.file or written
                    yield Fault(loc, f"{shown(where, 200)}: {fault.message}", fault.remedy)


def folder_of(design: Design) -> Path:
    """The folder of a design's data files; the working folder if it has none."""
    folders = (file.folder for _, _, file in _files(design, Design) if isinstance(file, DataFile))
    return Path(next(folders, ""))


def replace_by_digests(tree: Any, section: Section) -> None:
    """Replace names of data files in the tree of a section by digests of their numbers.

    A hash of the tree then counts the content of a file, not its name.
    """
    for loc, kind, file in _files(section, type(section)):
        block = dict(child_at(section, loc[:-1]))
        content = kind.parse(as_read(file, ".".join(map(str, loc))), block)
        child_at(tree, loc[:-1])[loc[-1]] = content.digest
