"""Read and check design files in one pass; every fault has its line and column.

`load` reads other types of file, such as scenarios, in the same way.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import field, replace
from pathlib import Path
from typing import Any

from ..base import errors
from ..base.arguments import Change
from ..base.dataclass import dataclass
from ..base.errors import Diagnostic, Fault, InputError
from ..base.files import read_bytes
from ..base.quantities import Quantity
from . import layup
from .build import MOST_FAULTS, Root, build
from .changes import Changed, Override, changed, meaningless
from .data_file import DataFile
from .data_file_reader import attach
from .ideal import completed
from .kinds import Section, ValueFault
from .model import Design
from .paths import resolve, spell
from .structure import Loc, MaterialLookup
from .yaml_source import MAX_BYTES, Document, NodeSpan, decode, parse

TEXT = "<text>"
STDIN = "<stdin>"


@dataclass(frozen=True, slots=True)
class FileSource:
    """Locations of the values of a file, so that faults found later can name line and column."""

    document: Document
    overrides: Mapping[Loc, Override] = field(default_factory=dict)
    """Values that the command line or another file sets, by location."""
    root: type[Section] = Design
    """Class of the object that the whole file describes."""
    metrics: Mapping[str, Quantity] | None = None
    """Metrics that requirements may name; default: `metrics.METRICS`."""

    @property
    def file(self) -> str:
        """Name of the file as the user wrote it."""
        return self.document.file

    @property
    def text(self) -> str:
        """Text of the file."""
        return self.document.text

    def diagnostic(self, path: str, message: str, remedy: str = "") -> Diagnostic:
        """Diagnostic for the value at a PATH; it points at the block if the file lacks the PATH."""
        try:
            loc = resolve(path, self.document.data, self.metrics, self.root).loc
        except ValueFault:
            return self.at(Fault(tuple(path.split(".")), message, remedy, at_key=True), path)
        return self.at(Fault(loc, message, remedy), path)

    def of_variable(self, path: str, message: str, remedy: str = "") -> Diagnostic:
        """Diagnostic for the entry of a PATH in the block `variables`."""
        return self.at(Fault(("variables", path), message, remedy, at_key=True), path)

    def at(self, fault: Fault, path: str | None = None) -> Diagnostic:
        """Convert a fault to a diagnostic with line and column."""
        if path is None:
            path = spell(fault.loc, self.document.data) or None
        if path is not None:
            path = errors.shown(path, 120)
        place = self._find(fault)
        if isinstance(place, Override):
            if place.value is None and fault.message.startswith("missing"):
                return place.diagnostic("cannot be unset: it is required", "set it instead", path)
            return place.diagnostic(fault.message, fault.remedy, path)
        return self.document.diagnostic(place, fault.message, fault.remedy, path)

    def place(self, fault: Fault) -> tuple[int, int]:
        """Line and column of a fault, for sorting."""
        span = self._find(fault)
        return span[:2] if isinstance(span, NodeSpan) else (0, 0)

    def _find(self, fault: Fault) -> NodeSpan | Override | None:
        """Location in the text of the faulty value, else of the nearest block around it.

        If the value was set from outside the file, its override is returned instead.
        """
        for depth in range(len(fault.loc), -1, -1):
            loc = fault.loc[:depth]
            if loc in self.overrides:
                return self.overrides[loc]
            span = self.document.values.get(loc)
            if span is None:
                for other, override in self.overrides.items():
                    if other[:depth] == loc:
                        return override  # the block itself was set from outside
            if fault.at_key or depth < len(fault.loc):
                span = self.document.keys.get(loc) or span
            if span is not None:
                return span
        return None


@dataclass(frozen=True, slots=True)
class LoadedDesign:
    """A design and its source."""

    design: Design
    source: FileSource


def read_design(
    source: str | Path,
    *,
    overrides: Iterable[Override | Change] = (),
    materials: MaterialLookup | None = None,
    metrics: Mapping[str, Quantity] | None = None,
    files: Mapping[str, str] | None = None,
) -> LoadedDesign:
    """Read a design file, or its text, and the data files that it names.

    Parameters
    ----------
    source : path, ``"-"`` for standard input, or a text of several lines
    overrides : (PATH, value) pairs that replace values before all checks; a bare number is
        in SI, but a value that comes from another file needs its unit; None removes the key
    materials : names and kinds of materials; default: the library
    metrics : metrics that may be named; default: `metrics.METRICS`
    files : texts of files that the design names, by name, to use instead of these files

    Raises
    ------
    InputError
        with all faults, in line order; those at lines of other files come first
    """
    text, file = opened(source)
    folder = Path() if file in (TEXT, STDIN) else Path(source).parent
    known = {name: DataFile(name, text, str(folder)) for name, text in (files or {}).items()}
    beside: list[Diagnostic] = []
    document = layup.expanded(parse(text, file))

    def build_design(tree: dict[str, Any]) -> tuple[Design | None, Sequence[Fault]]:
        lookup = library() if materials is None else materials
        whole, unused = completed(tree)
        file_faults = list(attach(whole, folder, known))
        beside[:] = [fault for fault in file_faults if isinstance(fault, Diagnostic)]
        built = build(whole, materials=lookup, metrics=metrics)
        faults = [*unused, *built.faults, *(x for x in file_faults if isinstance(x, Fault))]
        return (None if faults else built.design), faults

    return LoadedDesign(*load(document, Design, build_design, overrides, metrics, beside))


def load(
    document: Document,
    root: type[Root],
    build_section: Callable[[dict[str, Any]], tuple[Root | None, Sequence[Fault]]],
    overrides: Iterable[Override | Change] = (),
    metrics: Mapping[str, Quantity] | None = None,
    beside: Sequence[Diagnostic] = (),
) -> tuple[Root, FileSource]:
    """Build the object that a document describes, and record the locations of its values.

    Parameters
    ----------
    document : parsed YAML
    root : class of the object, derived from `Section`
    build_section : function that builds the object from a tree, or lists the faults of the tree
    overrides : values that replace those of the document, as for `read_design`
    metrics : metrics that may be named; default: `metrics.METRICS`
    beside : faults at lines of other files, which `build_section` updates

    Raises
    ------
    InputError
        with all faults, in line order
    """
    _require_kind(document)
    given = [Override(*change) for change in overrides]

    def with_changes(used: Sequence[Override]) -> Changed:
        return changed(document, root, metrics, used)

    new = with_changes(given)
    faults = [*document.faults, *new.faults]
    source = FileSource(document, new.places, root, metrics)
    section, section_faults = build_section(new.tree)
    faults += beside
    if section_faults and new.choices:
        advice, section_faults = meaningless(
            new, section_faults, lambda tree: build_section(tree)[1],
            lambda choice: with_changes([x for x in given if x is not choice]).tree,
        )  # fmt: skip
        faults += advice
    reported = _once([f for f in section_faults if not _unusable(f, document)], document)
    if section is None or faults or reported:
        raise InputError(_in_order(source, faults, reported))
    return section, source


_MARKS = {"design": "cylinder", "scenario": "design"}
"""Key by which each kind of file is recognised."""


def is_scenario(source: str | Path) -> bool:
    """Whether a file, or a text of several lines, is a scenario, even if it names no design."""
    data = parse(*opened(source, "design")).data
    return (_MARKS["scenario"] in data or "duration" in data) and _MARKS["design"] not in data


def _require_kind(document: Document) -> None:
    """Raise an error if a scenario is given where a design is required, or the reverse."""
    for kind, mark in _MARKS.items():
        if mark in document.data and _MARKS[document.kind] not in document.data:
            remedy = "give the design file that the scenario names"
            if kind == "design":
                remedy = f'name it in a scenario: "design: {Path(document.file).name}"'
            message = f"the file is a {kind}, not a {document.kind}"
            raise InputError(document.diagnostic(document.keys.get((mark,)), message, remedy))


def _unusable(fault: Fault, document: Document) -> bool:
    return any(fault.loc[: len(loc)] == loc for loc in document.unusable)


def _once(faults: Sequence[Fault], document: Document) -> list[Fault]:
    """Report a fault only once if several layers of one compact lay-up entry have it."""
    unique, seen = [], set()
    for fault in faults:
        shorthand = document.shorthand(fault.loc)
        if shorthand is not None:
            key = (shorthand, fault.loc[len(shorthand.wall) + 1 :], fault.message)
            if key in seen:
                continue
            seen.add(key)
        unique.append(fault)
    return unique


def _in_order(
    source: FileSource, diagnostics: Sequence[Diagnostic], faults: Sequence[Fault]
) -> list[Diagnostic]:
    """Sort faults by line and column; keep at most `MOST_FAULTS` and state how many are omitted.

    Faults of other files and of the command line come first.
    """
    first = sorted(faults, key=source.place)[:MOST_FAULTS]
    ordered = [*diagnostics, *(source.at(fault) for fault in first)]
    ordered.sort(key=lambda f: (f.file == source.file, f.line or 0, f.column or 0))
    omitted = len(diagnostics) + len(faults) - MOST_FAULTS
    if omitted > 0:
        more = Diagnostic(f"and {omitted} more faults", "correct these first", source.file)
        ordered = [*ordered[:MOST_FAULTS], more]
    return ordered


def opened(source: str | Path, kind: str = "design") -> tuple[str, str]:
    """Text and name of a source: a file, standard input, or a text of several lines."""
    if isinstance(source, str) and ("\n" in source or "\r" in source):
        return source, TEXT
    if isinstance(source, str) and not source.strip():
        raise InputError(Diagnostic("the path is empty", f"name a {kind} file"))
    name = STDIN if source == "-" else str(source)
    try:
        data = read_bytes(source, most=MAX_BYTES + 1, kinds=(".yaml", ".yml"), what=f"{kind} file")
    except InputError as error:
        if ": " not in name:
            raise
        remedy = "name a file; a text needs at least two lines"
        raise InputError([replace(x, remedy=remedy) for x in error.diagnostics]) from None
    return decode(data, name, kind), name


def library() -> MaterialLookup:
    """Load the shipped material library."""
    from .materials import load_library

    return load_library()
