"""Read the files of duty cycles that a design names into its tree, and find them there."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

from ..base.errors import Diagnostic, Fault, InputError, shown
from .cycle_files import CycleFile, CycleFileName
from .cycle_record import cycle_text
from .kinds import ValueFault
from .model import Design
from .structure import Loc, child_at

CYCLES: Loc = ("duty", "cycles")
"""Location of the list of cycles in a design."""


def attach(
    tree: Any, folder: Path, known: dict[str, CycleFile] | None = None
) -> Iterator[Fault | Diagnostic]:
    """Read all cycle files that a tree names, and put their contents into the tree.

    Parameters
    ----------
    tree : a design's tree of dicts and lists; values of `file` are replaced
    folder : folder to which the names are relative, unless the tree has files of another folder
    known : files that are read already, by name; new ones are added

    Yields
    ------
    a fault for every file as a whole, and a diagnostic for every fault at a line of a file
    """
    known = {} if known is None else known
    cycles = child_at(tree, CYCLES)
    for index, cycle in enumerate(cycles if isinstance(cycles, list) else ()):
        if not isinstance(cycle, dict) or not isinstance(cycle.get("file"), str):
            continue
        loc: Loc = (*CYCLES, index, "file")
        try:
            cycle["file"] = _read(cycle["file"], folder, known)
            cycle["file"].record(closed=_closed(cycle), ignore=_ignored(cycle))
        except ValueFault:  # a name that is no text is a fault of its own
            continue
        except InputError as error:
            for fault in error.diagnostics:
                if fault.line is not None:
                    yield fault
                else:
                    where = fault.file or cycle["file"]
                    yield Fault(loc, f"{shown(where, 200)}: {fault.message}", fault.remedy)


def _closed(cycle: Mapping[str, Any]) -> bool:
    """Whether a cycle of a tree repeats; its value may still be a text."""
    return str(cycle.get("closed", True)).strip().lower() not in ("false", "no", "off", "0")


def _ignored(cycle: Mapping[str, Any]) -> tuple[str, ...]:
    names = cycle.get("ignore")
    return tuple(map(str, names)) if isinstance(names, (list, tuple)) else ()


def _read(written: str, folder: Path, known: dict[str, CycleFile]) -> CycleFile:
    if isinstance(written, CycleFile):
        return written
    written = written if "\n" in written else written.strip()
    if written not in known:
        CycleFileName("", "walk.csv").validate(written)
        text = written if "\n" in written else cycle_text(folder / written)
        known[written] = CycleFile(written, text, str(folder))
    return known[written]


def files_of(tree: Any) -> dict[str, CycleFile]:
    """The cycle files that a tree or a design names, by name."""
    cycles = child_at(tree, CYCLES) or ()
    values = (child_at(cycle, ("file",)) for cycle in cycles)
    files = (value for value in values if isinstance(value, CycleFile))
    return {str(file): file for file in files if not file.inside}


def texts_of(design: Design) -> dict[str, str]:
    """Contents of the cycle files that a design names, by name; see `reader.read_design`."""
    return {name: file.text for name, file in files_of(design).items()}


def moved(design: Design, folder: Path) -> Design:
    """The design with names of cycle files relative to another folder, where it will be written."""
    return _with_files(design, lambda file: file.moved(folder))


def portable(design: Design) -> Design:
    """The design with the texts of its cycles in place of files, so that its file is complete."""
    return _with_files(design, lambda file: file.portable())


def _with_files(design: Design, change: Callable[[CycleFile], CycleFile]) -> Design:
    if design.duty is None:
        return design
    cycles = tuple(
        cycle.model_copy(update={"file": change(cycle.file)})
        if isinstance(cycle.file, CycleFile)
        else cycle
        for cycle in design.duty.cycles
    )
    return design.model_copy(update={"duty": design.duty.model_copy(update={"cycles": cycles})})


def folder_of(tree: Any) -> Path:
    """The folder of a design's cycle files; the working folder if it has none."""
    return Path(next((file.folder for file in files_of(tree).values()), ""))
