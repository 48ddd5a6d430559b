"""Parse YAML into a tree of texts with locations; ambiguous YAML is refused or kept as text.

Scalars stay text as written: no booleans, octals, sexagesimals, dates or floats are resolved.
Anchors, aliases, tags and merge keys are refused, so a document cannot grow when read.
"""

from __future__ import annotations

import re
from dataclasses import field
from functools import lru_cache
from typing import Any, NamedTuple

import yaml

from ..base.dataclass import dataclass
from ..base.errors import Diagnostic, InputError, shown
from .structure import Loc

try:
    from yaml.cyaml import CParser as _Parser  # type: ignore[attr-defined]
except ImportError:  # PyYAML without libyaml gives the same events, but more slowly
    from yaml.parser import Parser
    from yaml.reader import Reader
    from yaml.scanner import Scanner

    class _Parser(Reader, Scanner, Parser):  # type: ignore[no-redef]
        def __init__(self, stream: str) -> None:
            Reader.__init__(self, stream)
            Scanner.__init__(self)
            Parser.__init__(self)


MAX_BYTES = 1_000_000
MAX_DEPTH = 50
MAX_NODES = 20_000

_BREAK = re.compile("\r\n|[\n\r\x85\u2028\u2029]")
_CONTROL = re.compile("[\x00-\x08\x0b\x0c\x0e-\x1f\x7f\x80-\x84\x86-\x9f\ud800-\udfff\ufffe\uffff]")
_START = {
    "design": "start with: actuator-opt init",
    "scenario": 'start with the keys "name:" and "design:"',
    "units": "write a line for each column, e.g. p1: bar",
}


class NodeSpan(NamedTuple):
    """Location of a node: line and column, both from 1, and its characters ``text[start:end]``."""

    line: int
    column: int
    start: int
    end: int


class Shorthand(NamedTuple):
    """One compact entry of a lay-up, expanded to the entries `first` to `first + layers - 1`."""

    wall: Loc
    first: int
    layers: int
    entry: NodeSpan


@lru_cache(maxsize=4)
def _lines(text: str) -> list[str]:
    """Lines of a text; only faults need them."""
    return _BREAK.split(text)


@dataclass(slots=True)
class Document:
    """A parsed YAML file: its tree of texts, and the locations of keys and values."""

    file: str
    text: str
    data: dict[str, Any] = field(default_factory=dict)
    values: dict[Loc, NodeSpan] = field(default_factory=dict)
    keys: dict[Loc, NodeSpan] = field(default_factory=dict)
    faults: list[Diagnostic] = field(default_factory=list)
    """Faults that do not stop the parser: duplicate keys, tags, anchors."""
    unusable: set[Loc] = field(default_factory=set)
    """Locations of values that cannot be read (aliases)."""
    shorthands: tuple[Shorthand, ...] = ()
    """Entries in compact notation, which `layup.expanded` replaces by layers."""
    kind: str = "design"
    """Kind of the file: design, scenario or units."""

    @property
    def lines(self) -> list[str]:
        """The text by lines."""
        return _lines(self.text)

    def shorthand(self, loc: Loc) -> Shorthand | None:
        """The compact entry that contains a location."""
        for shorthand in self.shorthands:
            depth = len(shorthand.wall)
            if len(loc) > depth and loc[:depth] == shorthand.wall:
                index = loc[depth]
                if isinstance(index, int) and 0 <= index - shorthand.first < shorthand.layers:
                    return shorthand
        return None

    def diagnostic(
        self, span: NodeSpan | None, message: str, remedy: str = "", path: str | None = None
    ) -> Diagnostic:
        """Diagnostic at a location of this file."""
        line, column = (span.line, span.column) if span else (None, None)
        source = None
        if line is not None and line <= len(lines := self.lines):
            text = lines[line - 1].replace("\t", " ")
            source = text if 0 < len(text) <= 200 and text.isprintable() else None
        return Diagnostic(message, remedy, self.file, line, column, path, source)


def decode(data: bytes, file: str, kind: str = "design") -> str:
    """Decode a file; raise `InputError` if it is no valid UTF-8 or too large."""
    if len(data) > MAX_BYTES:
        raise InputError(
            Diagnostic(
                f"the file is larger than {MAX_BYTES / 1e6:.0f} MB",
                f"a {kind} file has a few kilobytes: is this the right file?",
                file,
            )
        )
    if data.startswith((b"\xff\xfe", b"\xfe\xff")):
        raise InputError(Diagnostic("the file is UTF-16", "save it as UTF-8", file))
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        before = data[: error.start].decode("utf-8-sig")
        line, column = _line_column(before, len(before))
        message = f"not UTF-8: byte 0x{data[error.start]:02x}"
        diagnostic = Diagnostic(message, "save the file as UTF-8", file, line, column)
        raise InputError(diagnostic) from None


def parse(text: str, file: str, kind: str = "design") -> Document:
    """Parse a YAML text into a tree; raise `InputError` if this is impossible."""
    text = text.removeprefix("\ufeff")
    document = Document(file, text, kind=kind)
    if len(text) > MAX_BYTES:
        decode(text.encode("utf-8", "replace"), file, kind)
    control = _CONTROL.search(text)
    if control is not None:
        line, column = _line_column(text, control.start())
        span = NodeSpan(line, column, control.start(), control.end())
        name = f"U+{ord(control[0]):04X}"
        raise InputError(document.diagnostic(span, f"control character {name}", "remove it"))
    try:
        _Builder(document).run(_Parser(text))
    except yaml.MarkedYAMLError as error:
        raise InputError([*document.faults, _syntax_fault(document, error)]) from None
    except _Stop as stop:
        raise InputError([*document.faults, stop.diagnostic]) from None
    return document


def _line_column(text: str, index: int) -> tuple[int, int]:
    breaks = [m.end() for m in _BREAK.finditer(text, 0, index)]
    return len(breaks) + 1, index - (breaks[-1] if breaks else 0) + 1


class _Stop(Exception):
    def __init__(self, diagnostic: Diagnostic) -> None:
        self.diagnostic = diagnostic


@dataclass(slots=True)
class _Frame:
    """A mapping or list that the parser has not closed yet; if `loc` is None, it is discarded."""

    node: dict[str, Any] | list[Any]
    loc: Loc | None
    start: Any
    key: str | None = None
    """Key of the next value; None if a key must come next."""
    drop: bool = False
    """Whether the next value belongs to a refused key and is dropped."""


class _Builder:
    """Builds the tree from parser events, without recursion, and limits its depth and size."""

    def __init__(self, document: Document) -> None:
        self.document = document
        self.stack: list[_Frame] = []
        self.root: Any = None

    def run(self, parser: Any) -> None:
        documents = nodes = 0
        while True:
            event = parser.get_event()
            if isinstance(event, yaml.StreamEndEvent) or event is None:
                break
            if isinstance(event, yaml.DocumentStartEvent):
                documents += 1
                if documents > 1:
                    advice = f"write one {self.document.kind} per file"
                    self._stop(event, "a second document starts here", advice)
            elif isinstance(event, yaml.NodeEvent):
                nodes += 1
                if nodes > MAX_NODES:
                    self._stop(event, f"more than {MAX_NODES} values", "split the file")
                self._node(event)
            elif isinstance(event, (yaml.MappingEndEvent, yaml.SequenceEndEvent)):
                self._close(event)
        span, kind = NodeSpan(1, 1, 0, 0), self.document.kind
        start = _START[kind]
        if self.root is None:
            self._stop_at(span, "the file is empty", start)
        if not isinstance(self.root, dict):
            self._stop_at(
                self.document.values.get((), span),
                f"the file is not a {kind}: it must consist of keys with values",
                start,
            )
        self.document.data = self.root

    def _node(self, event: Any) -> None:
        frame = self.stack[-1] if self.stack else None
        if frame is not None and isinstance(frame.node, dict) and frame.key is None:
            if isinstance(event, yaml.ScalarEvent):
                self._key(frame, event)
                return
            self._fault(event, "a key must be one word", "write key: value")
            self._refuse_key(frame, event)
            return
        loc = self._loc(frame)
        self._refuse_features(loc, event)
        value: Any = None
        if isinstance(event, yaml.ScalarEvent):
            value = None if event.value == "" and event.implicit[0] else event.value
        elif isinstance(event, (yaml.MappingStartEvent, yaml.SequenceStartEvent)):
            if len(self.stack) >= MAX_DEPTH:
                self._stop(event, f"nested deeper than {MAX_DEPTH} levels", "flatten the file")
            value = {} if isinstance(event, yaml.MappingStartEvent) else []
        self._place(loc, event)
        self._attach(frame, value)
        if isinstance(value, (dict, list)):
            self.stack.append(_Frame(value, loc, event.start_mark))

    def _key(self, frame: _Frame, event: Any) -> None:
        key = event.value
        self._refuse_features(frame.loc, event)
        loc = None if frame.loc is None else (*frame.loc, key)
        frame.key = key
        if key == "<<":
            self._fault(event, "merge keys are not supported", "write the values out")
            frame.drop = True
        elif key in frame.node:
            first = self.document.keys.get(loc) if loc is not None else None
            where = f" at line {first.line}, column {first.column}" if first else ""
            self._fault(event, f'duplicate key "{shown(key)}", first{where}', "keep one of them")
            frame.drop = True
        elif loc is not None:
            self.document.keys[loc] = _span(event)

    def _refuse_key(self, frame: _Frame, event: Any) -> None:
        """Skip a key that is itself a block or list, together with its value."""
        frame.key, frame.drop = "", True
        if isinstance(event, (yaml.MappingStartEvent, yaml.SequenceStartEvent)):
            node: Any = {} if isinstance(event, yaml.MappingStartEvent) else []
            self.stack.append(_Frame(node, None, event.start_mark, drop=False))

    def _close(self, event: Any) -> None:
        frame = self.stack.pop()
        if frame.loc is not None and frame.loc in self.document.values:
            span = self.document.values[frame.loc]
            self.document.values[frame.loc] = span._replace(end=event.end_mark.index)

    def _loc(self, frame: _Frame | None) -> Loc | None:
        if frame is None:
            return ()
        if frame.loc is None or frame.drop:
            return None
        return (*frame.loc, len(frame.node) if isinstance(frame.node, list) else frame.key or "")

    def _attach(self, frame: _Frame | None, value: Any) -> None:
        if frame is None:
            self.root = value
        elif isinstance(frame.node, list):
            frame.node.append(value)
        else:
            if not frame.drop and frame.key is not None:
                frame.node[frame.key] = value
            frame.key, frame.drop = None, False

    def _place(self, loc: Loc | None, event: Any) -> None:
        if loc is not None:
            self.document.values[loc] = _span(event)

    def _refuse_features(self, loc: Loc | None, event: Any) -> None:
        if isinstance(event, yaml.AliasEvent):
            self._fault(event, f'alias "*{event.anchor}"', "write the value out")
            if loc is not None:
                self.document.unusable.add(loc)
            return
        if event.anchor is not None:
            self._fault(event, f'anchor "&{event.anchor}"', "remove it")
        if event.tag is not None:
            self._fault(
                event, f'tag "{shown(event.tag)}"', "remove the tag; values are read as text"
            )

    def _fault(self, event: Any, message: str, remedy: str) -> None:
        if len(self.document.faults) < 100:
            self.document.faults.append(self.document.diagnostic(_span(event), message, remedy))

    def _stop(self, event: Any, message: str, remedy: str) -> None:
        self._stop_at(_span(event), message, remedy)

    def _stop_at(self, span: NodeSpan, message: str, remedy: str) -> None:
        raise _Stop(self.document.diagnostic(span, message, remedy))


def _span(event: Any) -> NodeSpan:
    start = event.start_mark
    return NodeSpan(start.line + 1, start.column + 1, start.index, event.end_mark.index)


_SYNTAX = (
    ("mapping values are not allowed", 'a ":" that does not fit here',
     'indent keys of one block alike, and quote texts that contain ": "'),
    ("could not find expected ':'", 'a key without ":"', "write key: value"),
    ("did not find expected key", "the indentation does not fit the lines above",
     "indent keys of one block alike"),
    ("did not find expected '-' indicator", "a key among list entries",
     'start each entry with "- " and indent its keys alike'),
    ("expected <block end>", "the indentation does not fit the lines above",
     "indent keys of one block alike"),
    ("did not find expected ',' or", "a bracket is not closed", "close the list or block"),
    ("expected ',' or", "a bracket is not closed", "close the list or block"),
    ("unexpected end of stream", "a quote is not closed", "close the quote"),
    ("document separator", "a quote is not closed", "close the quote"),
    ("<document start>", "text after the end of the document", "remove it"),
    ("nesting depth", f"nested deeper than {MAX_DEPTH} levels", "flatten the file"),
    ("escape", "unknown escape in a quoted text", "use single quotes"),
)  # fmt: skip


def _syntax_fault(document: Document, error: yaml.MarkedYAMLError) -> Diagnostic:
    problem = error.problem or "not YAML"
    mark = error.problem_mark or error.context_mark
    message, remedy = problem, "write key: value, one per line"
    for part, meaning, advice in _SYNTAX:
        if part in problem:
            message, remedy = meaning, advice
            if (
                "is not closed" in meaning or "without" in meaning
            ) and error.context_mark is not None:
                mark = error.context_mark
            break
    if mark is None:
        return document.diagnostic(None, message, remedy)
    before = "".join(document.lines[mark.line : mark.line + 1])[: mark.column].rstrip()
    if before.endswith(("]", "}")) and "does not fit the lines above" in message:
        message, remedy = f'text after "{before[-1]}"', "put the whole value in quotes"
    span = NodeSpan(mark.line + 1, mark.column + 1, mark.index, mark.index)
    character = document.text[mark.index : mark.index + 1]
    if "cannot start any token" in problem:
        if character == "\t":
            message, remedy = "a tab in the indentation", "indent with spaces"
        else:
            message, remedy = f'"{shown(character)}" cannot start a value', "put it in quotes"
    return document.diagnostic(span, message, remedy)
