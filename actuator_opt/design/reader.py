"""Design files: read, checked in one pass, every fault at its line and column."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final, Literal

from .. import suggest, units
from ..errors import Diagnostic, InputError
from ..quantities import Quantity
from ..store import read_bytes
from . import layup
from .build import MOST_FAULTS, build, copy_tree
from .kinds import ValueFault
from .model import Design
from .paths import put, resolve, spell
from .structure import Loc
from .view import Fault, Materials
from .yaml_source import MAX_BYTES, Document, Span, decode, parse

TEXT = "<text>"
STDIN = "<stdin>"
SET: Final = "--set"


@dataclass(frozen=True, slots=True)
class Source:
    """Where a design's values stand, for faults found later (by an evaluation, a plug-in)."""

    document: Document
    overrides: Mapping[Loc, str] = field(default_factory=dict)
    """Places set from outside the file, with the text that set them."""

    @property
    def file(self) -> str:
        """Name of the file, as the person wrote it."""
        return self.document.file

    @property
    def text(self) -> str:
        """The file's text."""
        return self.document.text

    def diagnostic(self, path: str, message: str, remedy: str = "") -> Diagnostic:
        """A fault of the value at a PATH; a PATH the file does not hold gets its block's place."""
        try:
            loc = resolve(path, self.document.data).loc
        except ValueFault:
            loc = ()
        return self.at(Fault(loc, message, remedy), path)

    def of_variable(self, path: str, message: str, remedy: str = "") -> Diagnostic:
        """A fault of the entry of a PATH under `variables`."""
        return self.at(Fault(("variables", path), message, remedy, at_key=True), path)

    def at(self, fault: Fault, path: str | None = None) -> Diagnostic:
        """A fault as a person reads it."""
        if path is None:
            path = spell(fault.loc, self.document.data) or None
        if path is not None:
            path = suggest.shown(path, 120)
        place = self._find(fault)
        if place == SET:
            return Diagnostic(fault.message, fault.remedy, SET, path=path)
        return self.document.diagnostic(place, fault.message, fault.remedy, path)

    def place(self, fault: Fault) -> tuple[int, int]:
        """Line and column of a fault, for sorting."""
        found = self._find(fault)
        return found[:2] if isinstance(found, Span) else (0, 0)

    def _find(self, fault: Fault) -> Span | Literal["--set"] | None:
        """The nearest place in the text at or above the fault's own."""
        for depth in range(len(fault.loc), -1, -1):
            loc = fault.loc[:depth]
            if loc in self.overrides:
                return SET
            span = self.document.values.get(loc)
            if span is None and any(other[:depth] == loc for other in self.overrides):
                return SET  # the block itself came from outside
            if fault.at_key or depth < len(fault.loc):
                span = self.document.keys.get(loc) or span
            if span is not None:
                return span
        return None


@dataclass(frozen=True, slots=True)
class LoadedDesign:
    """A design and where it was read."""

    design: Design
    source: Source


def read_design(
    source: str | Path,
    *,
    overrides: Iterable[tuple[str, str]] = (),
    materials: Materials | None = None,
    metrics: Mapping[str, Quantity] | None = None,
) -> LoadedDesign:
    """Read a design file, or the text of one.

    Parameters
    ----------
    source : path, ``"-"`` for standard input, or a text of several lines
    overrides : (PATH, value) pairs that replace values before anything is checked; a bare
        number is SI
    materials : names and kinds of materials; default: the library
    metrics : metrics that may be named; default: `quantities.METRICS`

    Raises
    ------
    InputError
        with every fault, in the order of the file's lines
    """
    text, file = _open(source)
    return read_document(
        parse(text, file), overrides=overrides, materials=materials, metrics=metrics
    )


def read_document(
    document: Document,
    *,
    overrides: Iterable[tuple[str, str]] = (),
    materials: Materials | None = None,
    metrics: Mapping[str, Quantity] | None = None,
) -> LoadedDesign:
    """The design of a parsed YAML document; parameters as `read_design`."""
    document = layup.expanded(document)
    tree = copy_tree(document.data)
    faults = list(document.faults)
    places: dict[Loc, str] = {}
    for path, value in overrides:
        try:
            target = resolve(path, tree, metrics)
            put(tree, target, _bare_is_si(value, target.quantity))
            places[target.loc] = value
        except ValueFault as fault:
            message = fault.message.removeprefix(f"{path}: ")
            faults.append(Diagnostic(message, fault.remedy, SET, path=suggest.shown(path, 120)))
    source = Source(document, places)
    built = build(tree, materials=library() if materials is None else materials, metrics=metrics)
    found = _once([f for f in built.faults if not _unusable(f, document)], document)
    if built.design is None or faults or found:
        raise InputError(_in_order(source, faults, found))
    return LoadedDesign(built.design, source)


def _unusable(fault: Fault, document: Document) -> bool:
    return any(fault.loc[: len(loc)] == loc for loc in document.unusable)


def _once(faults: Sequence[Fault], document: Document) -> list[Fault]:
    """Faults that the layers of one compact entry share, said at the first of them."""
    found, said = [], set()
    for fault in faults:
        shorthand = document.shorthand(fault.loc)
        if shorthand is not None:
            same = (shorthand, fault.loc[len(shorthand.wall) + 1 :], fault.message)
            if same in said:
                continue
            said.add(same)
        found.append(fault)
    return found


def _in_order(
    source: Source, said: Sequence[Diagnostic], found: Sequence[Fault]
) -> list[Diagnostic]:
    """Faults by line and column, at most `MOST_FAULTS` and a line that counts the rest."""
    first = sorted(found, key=source.place)[:MOST_FAULTS]
    everything = [*said, *(source.at(fault) for fault in first)]
    everything.sort(key=lambda fault: (fault.line or 0, fault.column or 0))
    left = len(said) + len(found) - MOST_FAULTS
    if left > 0:
        more = Diagnostic(f"and {left} more faults", "mend these first", source.file)
        everything = [*everything[:MOST_FAULTS], more]
    return everything


def _bare_is_si(value: str, quantity: Quantity | None) -> str:
    """`value` with the SI unit where it is a bare number."""
    if quantity is None:
        return value
    try:
        number, unit = units.split(value)
    except units.UnitError:
        return value
    if unit:
        return value
    return f"{number * 100!r} %" if quantity.name == "fraction" else f"{value} {quantity.si_unit}"


def _open(source: str | Path) -> tuple[str, str]:
    if isinstance(source, str) and ("\n" in source or "\r" in source):
        return source, TEXT
    name = STDIN if source == "-" else str(source)
    data = read_bytes(source, most=MAX_BYTES + 1, kinds=(".yaml", ".yml"), what="design file")
    return decode(data, name), name


def library() -> Materials:
    """The shipped material library; imported when a design is read."""
    from .materials import load_library

    return load_library()
