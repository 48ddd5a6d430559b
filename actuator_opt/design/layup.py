"""Compact lay-up notation: ``plies: "[90_4 / +-25_2 / 0]s"`` instead of a list of layers.

Angles are in degrees from the tube axis, layers from the inside outwards::

    layup = item {"/" item}
    item  = angle ["_" n]  |  "+-" angle ["_" n]  |  "[" layup "]" ["_" n] ["s"]

``+-25`` (or ±25) is a balanced pair of plies. 25 without a sign is a single ply at +25 degrees; 0
and 90 have no sign. ``_n`` repeats a ply or group, and ``s`` mirrors a group. Neighbouring plies of
equal angle form one layer.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from decimal import Decimal
from typing import Any, NamedTuple

from ..base import quantities, units
from ..base.errors import Diagnostic, shown
from .kinds import ValueFault, example, read_quantity, shape_in_words
from .model import MOST_LAYERS, Ply
from .paths import spell
from .structure import Loc, child, child_at, lists_of
from .yaml_source import Document, NodeSpan, Shorthand

EXAMPLE = "[90_4 / +-25_2 / 0]s"
MOST_REPEATS = 999
_LONGEST = 1000
_DEEPEST = 20
_TOKEN = re.compile(
    r"\s*(?:(?P<pair>\+/-|\+-|±)|(?P<sign>[+-])|(?P<number>[0-9]+(?:\.[0-9]*)?|\.[0-9]+)"
    r"|(?P<mark>[\[\]/_sS])|(?P<odd>[^\W\d_]+|\S))"
)
_OWN_KEYS = ("plies", "ply_thickness", "angle", "thickness", "balanced")
"""Keys of a compact entry that define its layers; other keys are copied to a layer as written."""


class NotationFault(ValueFault):
    """A fault in the notation of a lay-up, with the position of the faulty character."""

    def __init__(self, offset: int, message: str, remedy: str) -> None:
        super().__init__(message, remedy)
        self.offset = offset


class PlyGroup(NamedTuple):
    """Neighbouring plies of one angle; `offset` is their position in the notation."""

    angle: str
    balanced: bool
    plies: int
    offset: int

    def same(self, other: PlyGroup) -> bool:
        """Whether two layers are equal apart from their number of plies."""
        return (float(self.angle), self.balanced) == (float(other.angle), other.balanced)


def read_notation(text: str, most: int = MOST_LAYERS) -> tuple[PlyGroup, ...]:
    """Read the layers of a notation, from the inside outwards.

    Raises
    ------
    NotationFault
        if it is no lay-up, an angle exceeds 90 degrees, or there are more than `most` layers

    >>> [(layer.angle, layer.balanced, layer.plies) for layer in read_notation("[90_2 / +-25]s")]
    [('90', True, 2), ('25', True, 4), ('90', True, 2)]
    """
    if len(text) > _LONGEST:
        raise NotationFault(
            0, f"a lay-up of {len(text)} characters is too long", f"write at most {_LONGEST}"
        )
    tokens = [
        (str(m.lastgroup), m[str(m.lastgroup)], m.start(str(m.lastgroup)))
        for m in _TOKEN.finditer(text)
    ]
    parser = _Parser([*tokens, ("end", "", len(text.rstrip()))], most)
    layers = parser.layup(0)
    if parser.kind != "end":
        raise parser.unexpected('a "/" or the end')
    return tuple(layers)


def _joined(layers: Sequence[PlyGroup]) -> list[PlyGroup]:
    """Merge neighbouring layers of equal angle."""
    joined: list[PlyGroup] = []
    for layer in layers:
        if joined and joined[-1].same(layer):
            joined[-1] = joined[-1]._replace(plies=joined[-1].plies + layer.plies)
        else:
            joined.append(layer)
    return joined


class _Parser:
    """Recursive-descent parser of a notation."""

    def __init__(self, tokens: Sequence[tuple[str, str, int]], most: int) -> None:
        self.tokens = tokens
        self.most = most
        self.at = 0

    @property
    def kind(self) -> str:
        return self.tokens[self.at][0]

    @property
    def text(self) -> str:
        return self.tokens[self.at][1]

    @property
    def offset(self) -> int:
        return self.tokens[self.at][2]

    def unexpected(self, expected: str) -> NotationFault:
        """Fault of a token that violates the grammar."""
        text, remedy = self.text, f'write e.g. "{EXAMPLE}"'
        if self.kind == "end":
            return NotationFault(
                self.offset, f"the lay-up ends where {expected} is expected", remedy
            )
        if text in ",;|":
            remedy = 'separate plies by "/"'
        elif text in ("deg", "°", "rad"):
            remedy = "angles are in degrees, without a unit"
        elif text in ("s", "S"):
            remedy = f"s mirrors a group in brackets, {remedy}"
        elif text == "]":
            remedy = 'remove it, or open a "["'
        return NotationFault(self.offset, f'"{shown(text)}" where {expected} is expected', remedy)

    def layup(self, depth: int) -> list[PlyGroup]:
        """Read items separated by slashes."""
        layers = self.item(depth)
        while self.text == "/":
            self.at += 1
            layers = [*layers, *self.item(depth)]
        return self.limited(layers)

    def limited(self, layers: Sequence[PlyGroup]) -> list[PlyGroup]:
        """Merge neighbouring layers of equal angle; raise a fault if too many layers remain."""
        joined = _joined(layers)
        if len(joined) > self.most:
            message = f"more than {self.most} layers"
            raise NotationFault(joined[self.most].offset, message, "write fewer")
        return joined

    def item(self, depth: int) -> list[PlyGroup]:
        """Read a ply, a pair or a group, with its number of repeats."""
        if self.text != "[":
            layer = self.ply()
            return [layer._replace(plies=layer.plies * self.repeats())]
        opened = self.offset
        if depth == _DEEPEST:
            raise NotationFault(opened, f"groups nested deeper than {_DEEPEST}", "write fewer")
        self.at += 1
        layers = self.layup(depth + 1)
        if self.kind == "end":
            raise NotationFault(opened, 'this "[" is not closed', 'write "]" after the group')
        if self.text != "]":
            raise self.unexpected('a "/" or "]"')
        self.at += 1
        layers = self.limited(layers * self.repeats())
        if self.text in ("s", "S"):
            self.at += 1
            layers = self.limited([*layers, *reversed(layers)])
        return layers

    def repeats(self) -> int:
        """Read the number of repeats after an underscore; 1 without an underscore."""
        if self.text != "_":
            return 1
        self.at += 1
        if self.kind != "number":
            raise self.unexpected("a number of repeats")
        count = units.whole(self.text)
        if count is None or not 1 <= count <= MOST_REPEATS:
            raise NotationFault(
                self.offset,
                f"{shown(self.text, 20)} repeats",
                f"write a whole number from 1 to {MOST_REPEATS}",
            )
        self.at += 1
        return count

    def ply(self) -> PlyGroup:
        """Read an angle with its sign."""
        offset, pair = self.offset, self.kind == "pair"
        signed, sign = self.kind in ("pair", "sign"), "-" if self.text == "-" else ""
        self.at += signed
        if self.kind != "number":
            raise self.unexpected("an angle" if signed else "a ply")
        size = float(self.text)
        if size > 90:
            message = f"{sign}{shown(self.text, 20)}: outside the valid range of an angle"
            raise NotationFault(offset, message, "write -90 to 90")
        plain = size in (0.0, 90.0)
        angle = self.text if plain else sign + self.text
        self.at += 1
        return PlyGroup(angle, pair or plain, 2 if pair else 1, offset)


def expanded(document: Document) -> Document:
    """Expand all compact entries into layers; faults still point at the compact text.

    Faults of an entry are added to the document. A faulty entry stays a single layer without
    thickness and is not checked further.
    """
    for wall in lists_of(Ply):
        items = child_at(document.data, wall)
        if isinstance(items, list) and any(isinstance(i, dict) and "plies" in i for i in items):
            document = _expand_wall(document, wall, items)
    return document


def _expand_wall(document: Document, wall: Loc, items: Sequence[Any]) -> Document:
    """Expand the compact entries of one wall; `starts[i]` is the index of entry i's first layer."""
    expanded_items: list[Any] = []
    starts: list[int] = []
    places: dict[Loc, NodeSpan] = {}
    faults: list[Diagnostic] = []
    unusable: set[Loc] = set()
    shorthands: list[Shorthand] = []
    for index, item in enumerate(items):
        first, loc = len(expanded_items), (*wall, index)
        starts.append(first)
        if not isinstance(item, dict) or "plies" not in item:
            expanded_items.append(item)
            continue
        entry_faults = list(_entry_faults(item))
        faults += [
            _diagnostic(document, loc, fault, (*wall, first))
            for fault in entry_faults
            if (*loc, fault.key) not in document.unusable
        ]
        layers = () if entry_faults or first > MOST_LAYERS else read_notation(item["plies"])
        if not layers:
            expanded_items.append({key: item[key] for key in item if key not in _OWN_KEYS})
            unusable.add((*wall, first, "thickness"))
            continue
        expanded_items += _entries(item, layers)
        shorthands.append(Shorthand(wall, first, len(layers), _extent(document, loc)))
        for number, layer in enumerate(layers):
            places |= _places(document, loc, (*wall, first + number), layer)
    if faults:  # PATHs into this entry would only repeat these faults
        variables = child(document.data, "variables")
        paths = variables if isinstance(variables, dict) else ()
        unusable |= {("variables", path) for path in paths if path.startswith(f"{spell(wall)}[")}

    def expanded_loc(loc: Loc) -> Loc:
        depth = len(wall)
        if len(loc) <= depth or loc[:depth] != wall:
            return loc
        return (*wall, starts[int(loc[depth])], *loc[depth + 1 :])

    return replace(
        document,
        data=_with(document.data, wall, expanded_items),
        values=places | {expanded_loc(loc): span for loc, span in document.values.items()},
        keys={expanded_loc(loc): span for loc, span in document.keys.items()},
        faults=[*document.faults, *faults],
        unusable={expanded_loc(loc) for loc in document.unusable} | unusable,
        shorthands=(*document.shorthands, *shorthands),
    )


def _with(node: Any, loc: Loc, value: Any) -> Any:
    """Copy a tree and replace the value at one location."""
    return value if not loc else {**node, loc[0]: _with(node[loc[0]], loc[1:], value)}


class _EntryFault(NamedTuple):
    """A fault of a compact entry: at a key, its value, or a character of the value."""

    key: str
    message: str
    remedy: str
    offset: int | None = None
    at_key: bool = False


def _entry_faults(item: Mapping[str, Any]) -> Iterator[_EntryFault]:
    """List all faults of a compact entry except those of its material."""
    for key in ("angle", "thickness", "balanced"):
        if key in item:
            message = f"both {key} and plies in one entry, but plies already defines {key}"
            yield _EntryFault(key, message, "keep one of them", at_key=True)
    thickness = quantities.INPUTS["ply_thickness"]
    if "ply_thickness" not in item:
        remedy = f'add e.g. "ply_thickness: {example(thickness)}"'
        yield _EntryFault("ply_thickness", "missing: required with plies", remedy)
    for key in ("plies", "ply_thickness"):
        value = item.get(key, "")
        try:
            if value is None:
                raise ValueFault("no value", "write one, or remove the line")
            if key == "ply_thickness" and key in item:
                read_quantity(value, thickness)
            elif key == "plies" and not isinstance(value, str):
                remedy = f'put it in quotes: plies: "{EXAMPLE}"'
                raise ValueFault(f"need a text, not {shape_in_words(value)}", remedy)
            elif key == "plies":
                read_notation(value)
        except NotationFault as fault:
            yield _EntryFault(key, fault.message, fault.remedy, fault.offset)
        except ValueFault as fault:
            yield _EntryFault(key, fault.message, fault.remedy)


def _diagnostic(document: Document, loc: Loc, fault: _EntryFault, first_loc: Loc) -> Diagnostic:
    """Diagnostic for the compact entry at `loc`, expanded into layers from `first_loc` on."""
    at = (*loc, fault.key)
    span = document.keys.get(at) if fault.at_key else document.values.get(at)
    if fault.offset is not None:
        span = _character(document, at, fault.offset)
    span = span or document.values.get(loc)
    return document.diagnostic(span, fault.message, fault.remedy, spell((*first_loc, fault.key)))


def _character(document: Document, loc: Loc, offset: int) -> NodeSpan | None:
    """Location of a character of a text; of the whole text if that is folded or has escapes."""
    span, value = document.values.get(loc), child_at(document.data, loc)
    if span is None or not isinstance(value, str):
        return span
    for quote in (0, 1):
        start = span.start + quote
        if document.text.startswith(value, start) and span.start <= start + len(value) <= span.end:
            at = quote + offset
            return NodeSpan(span.line, span.column + at, span.start + at, span.end)
    return span


def _entries(item: Mapping[str, Any], layers: Sequence[PlyGroup]) -> Iterator[dict[str, Any]]:
    """Layers of a compact entry as list entries; unknown keys stay in the first layer."""
    number, unit = units.split(item["ply_thickness"])
    for layer in layers:
        thickness = (Decimal(repr(number)) * layer.plies).normalize()
        entry: dict[str, Any] = {}
        for key in item if layer is layers[0] else ("material",):
            if key not in _OWN_KEYS and key in item:
                entry[key] = item[key]
        entry |= {"angle": f"{layer.angle} deg", "thickness": f"{thickness:f} {unit}"}
        entry |= {} if layer.balanced else {"balanced": "false"}
        yield entry | {"ply_thickness": item["ply_thickness"]}


def _places(document: Document, loc: Loc, layer_loc: Loc, layer: PlyGroup) -> dict[Loc, NodeSpan]:
    """Where a layer's values are written; its thickness is placed where its angle is."""
    angle_span = _character(document, (*loc, "plies"), layer.offset)
    places = {layer_loc: angle_span} | {
        (*layer_loc, key): angle_span for key in ("angle", "thickness", "balanced")
    }
    places |= {
        (*layer_loc, key): document.values.get((*loc, key)) for key in ("material", "ply_thickness")
    }
    return {place: span for place, span in places.items() if span is not None}


def _extent(document: Document, loc: Loc) -> NodeSpan:
    """Extent of a compact entry in the text: from its first key to the end of its last value."""
    span = document.values[loc]
    if document.text.startswith("{", span.start):
        return span
    below = [at for place, at in document.values.items() if place[: len(loc)] == loc != place]
    end = max(at.end for at in below)  # a block scalar ends at the beginning of the next line
    return span._replace(end=len(document.text[:end].rstrip()))
