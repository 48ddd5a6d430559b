"""A page as data: verdict, key figures, one large figure, and blocks below each other.

Subjects build a `Page`; `paper`, `terminal` and `html` render it. A block says where it belongs
(`on`): on paper, on the terminal, or on both; HTML shows what paper shows.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import Literal, TypeAlias

from ..base.errors import CONTROLS
from .chart import Curve, Panel
from .ink import Ink
from .text import STATUS_WORDS


@dataclass(frozen=True, slots=True, eq=False)
class Chart:
    """Panels side by side; a sequence of panels is a column.

    Parameters
    ----------
    title : of the block
    panels : panels and columns of panels, from the left; an ink stands below the panels of its
        column
    note : below the chart
    instead : what the terminal shows
    height : on paper [mm]
    widths : of the columns, relative; default: equal
    key : curves named once, above all panels
    """

    title: str
    panels: Sequence[Panel | Sequence[Panel | Ink]]
    note: str = ""
    instead: Table | TerminalFigure | None = None
    height: float = 64.0
    widths: Sequence[float] = ()
    key: Sequence[Curve] = ()

    @property
    def columns(self) -> list[list[Panel | Ink]]:
        """The panels by column."""
        return [[part] if isinstance(part, Panel) else [*part] for part in self.panels]


State: TypeAlias = Literal["", "met", "no_reserve", "missed", "not_checked", "checks", "infeasible"]
"""How a requirement, a check or a whole page fares; empty where nothing is judged."""
Medium: TypeAlias = Literal["both", "paper", "terminal"]
Align: TypeAlias = Literal["left", "center", "right"]

_PIECES = re.compile(r"(?:[^./=\[]|[./=\[]+(?=[0-9]))*(?:[./=\[]+|$)", re.DOTALL)
_NAMES = re.compile(r"[^_]*(?:_+|$)")
_NAME = 18
"""Letters of a single name that any column has room for."""
_WORDS = re.compile(r"\s*\S+\s*|\s+")
_CONTROL = re.compile(rf"[{CONTROLS}]")


def clean(text: str) -> str:
    """Printable text: control and direction characters as their code point, ``⟨U+0007⟩``."""
    return _CONTROL.sub(lambda m: f"⟨U+{ord(m[0]):04X}⟩", text)


_PAPER = re.compile(
    r"[^\n\t\u0020-\u007e\u00a0-\u02af\u0370-\u052f\u1e00-\u1eff\u2010-\u2029\u202f-\u205e"
    r"\u2070-\u209c\u20a0-\u20b5\u2100-\u2311\u2500-\u26b8\u2701-\u27be\u27e8\u27e9]"
)
"""What the report's typeface cannot draw (it covers Latin, Greek, Cyrillic and technical signs)."""


def printable(text: str) -> str:
    """Text that the typeface can draw; other letters as their code point, ``⟨U+4E2D⟩``."""
    if text.isascii():
        return text
    return _PAPER.sub(lambda m: f"⟨U+{ord(m[0]):04X}⟩", text)


def soft(text: str, longest: int = 14) -> str | list[str]:
    """A text that may break inside words beyond `longest` letters: behind ``. / = [``.

    A single name beyond what the column holds may break behind ``_`` too, then anywhere.

    >>> soft("materials.steel_42crmo4.density", 22)
    ['materials.', 'steel_42crmo4.', 'density']
    """
    text = clean(text)
    pieces: list[str] = [""]
    for word in _WORDS.findall(text):
        if len(word.rstrip()) <= longest:
            pieces[-1] += word
            continue
        first, *rest = _pieces(word, max(longest, _NAME))
        pieces[-1] += first
        pieces += rest
    return text if len(pieces) == 1 else pieces


def _pieces(word: str, most: int) -> Iterator[str]:
    """Parts of a word between which a line may break, none beyond `most` letters."""
    for part in filter(None, _PIECES.findall(word)):
        if len(part.rstrip()) <= most:
            yield part
            continue
        for name in filter(None, _NAMES.findall(part)):
            yield from (name[k : k + most] for k in range(0, len(name), most))


def short(text: str, length: int) -> str:
    """A text cut to `length` letters with an ellipsis."""
    text = clean(text)
    return text if len(text) <= length else text[: length - 1].rstrip() + "…"


@dataclass(frozen=True, slots=True)
class Status:
    """A state with its mark and its words; default: those of the state."""

    state: State
    text: str = ""

    @property
    def words(self) -> str:
        """The words."""
        return self.text or STATUS_WORDS[self.state]


@dataclass(frozen=True, slots=True)
class Bar:
    """A margin as a bar: room to the right of the mark, a miss to its left; full at 100 %."""

    margin: float | None
    met: bool = True


@dataclass(frozen=True, slots=True)
class Share:
    """A bar from zero to one."""

    value: float


@dataclass(frozen=True, slots=True)
class Slot:
    """Where a value lies between its bounds, from zero to one; `at` names the bound it is at."""

    place: float
    at: str = ""


FARTHEST = 0.3
"""Relative change at which the bar of a `Reach` ends; it has ticks at a third of that."""


@dataclass(frozen=True, slots=True)
class Reach:
    """How far a value may change, as a bar from its present place; None: as far as it was tried.

    `met`: whether the whole reach counts.
    """

    change: float | None
    met: bool = True


@dataclass(frozen=True, slots=True)
class Flag:
    """Words that stand out where `raised`."""

    text: str
    raised: bool


Cell: TypeAlias = str | list[str] | Status | Bar | Share | Slot | Reach | Flag
"""Text (in pieces: a line may break between them), or a mark."""


@dataclass(frozen=True, slots=True)
class Column:
    """A column of a table, on paper and on the terminal.

    Parameters
    ----------
    head : above it; a line break counts on paper
    align : of its cells
    width : "auto", a part of the room that is left (number), or ``"12mm"``; a column of the second
        kind shrinks on a narrow terminal
    breaks : letters of a word beyond which it may break; 0 never
    wraps : a cell too wide for the terminal goes on in further lines; otherwise it is cut
    mono, strong : type on paper; on the terminal strong is bold
    least : letters that a shrinking column keeps on the terminal
    drop : on a narrow terminal the columns of the highest number go first; 0 never
    style : on the terminal "bold", "dim", a colour, or "state": the colour of the row's state
    on : where the column is shown
    """

    head: str
    align: Align = "left"
    width: float | str = "auto"
    breaks: int = 0
    wraps: bool = False
    mono: bool = False
    strong: bool = False
    least: int = 14
    drop: int = 0
    style: str = ""
    on: Medium = "both"

    @property
    def flexible(self) -> bool:
        """Whether the column takes what the others leave."""
        return not isinstance(self.width, str)


@dataclass(frozen=True, slots=True)
class Row:
    """Cells of a table; the state colours what its columns say."""

    cells: Sequence[Cell]
    state: State = ""


@dataclass(frozen=True, slots=True)
class Table:
    """Rows under their heads, plain cells or with a state; a rule parts the last `total` of them.

    `headless` leaves the title out on the terminal, and so does an empty title. Where every head
    is empty, the terminal shows no line of heads. A table with `repeat` that is too wide is shown
    in parts, each of which begins with its first `repeat` columns.
    """

    title: str
    columns: Sequence[Column]
    rows: Sequence[Row | Sequence[Cell]]
    note: str = ""
    total: int = 0
    headless: bool = False
    repeat: int = 0
    on: Medium = "both"

    def parts(self, widths: Sequence[float], room: float) -> list[Table]:
        """The table in parts that fit a room; `widths` of its columns include their gaps."""
        if not self.repeat or sum(widths) <= room:
            return [self]
        first, rest = list(range(self.repeat)), list(range(self.repeat, len(self.columns)))
        parts = []
        while rest:
            shown = [*first, rest.pop(0)]
            while rest and sum(widths[k] for k in (*shown, rest[0])) <= room:
                shown.append(rest.pop(0))
            parts.append(self._of(shown))
        return parts

    def _of(self, shown: Sequence[int]) -> Table:
        """The table with these columns alone."""
        rows = [
            replace(row, cells=[row.cells[k] for k in shown])
            if isinstance(row, Row)
            else [row[k] for k in shown]
            for row in self.rows
        ]
        return replace(self, columns=[self.columns[k] for k in shown], rows=rows, repeat=0)


@dataclass(frozen=True, slots=True)
class Drawing:
    """A figure drawn in ink, with a title and what to know of it.

    `instead` is what the terminal shows.
    """

    title: str
    ink: Ink
    note: str = ""
    instead: TerminalFigure | Table | None = None


@dataclass(frozen=True, slots=True)
class TerminalFigure:
    """A curve in a few lines of text: points (x, y), a level, what stands below both ends."""

    title: str
    points: Sequence[tuple[float, float]]
    level: float | None = None
    ends: tuple[str, str] | None = None
    height: int = 7
    note: str = ""


@dataclass(frozen=True, slots=True)
class Notes:
    """Sentences under a title; `style` and `headless` as on the terminal."""

    title: str
    items: Sequence[str]
    note: str = ""
    headless: bool = False
    style: str = ""
    on: Medium = "both"


@dataclass(frozen=True, slots=True)
class Listing:
    """Numbered source text in monospace, on paper alone."""

    title: str
    text: str


@dataclass(frozen=True, slots=True)
class Pair:
    """Blocks side by side on paper; on the terminal one below the other."""

    sides: Sequence[Sequence[Block]]


Block: TypeAlias = Table | Drawing | Chart | TerminalFigure | Notes | Listing | Pair


@dataclass(frozen=True, slots=True)
class Verdict:
    """The badge: state, words in capitals, plain lines below, and cautions in amber."""

    state: State
    text: str
    lines: Sequence[str] = ()
    cautions: Sequence[str] = ()


@dataclass(frozen=True, slots=True)
class Tile:
    """A key figure: what it is, its number and unit, what to know of it."""

    label: str
    value: str
    unit: str = ""
    note: str = ""
    state: State = ""
    symbol: str = ""


@dataclass(frozen=True, slots=True)
class Page:
    """A page about one subject.

    Parameters
    ----------
    name, kind : its title, and what kind of page it is
    verdict, sentence : the badge, and one or two sentences beside it
    tiles : up to five key figures
    hero : the large figure below them, for a room of so many millimetres of height
    blocks : below each other
    scale : of the large figure, for the title block
    items : numbered parts of the large figure: (number, part, material)
    design : what the title block names; default: the name
    least : height that the large figure needs [mm]; blocks give way to it
    lists_input : whether the design file is listed at the end
    """

    name: str
    kind: str
    verdict: Verdict
    sentence: str
    tiles: Sequence[Tile]
    hero: Callable[[float], Ink]
    blocks: Sequence[Block] = field(default=())
    scale: str = ""
    items: Sequence[tuple[int, str, str]] = ()
    design: str = ""
    least: float = 0.0
    lists_input: bool = False


def text_table(
    title: str,
    heads: Sequence[str],
    rows: Sequence[Sequence[Cell]],
    note: str = "",
    widths: Sequence[float | str] = (),
) -> Table:
    """A table of texts: its columns share the room alike or by `widths`, and long words break."""
    columns = [
        Column(head, "left", width, breaks=14)
        for head, width in zip(heads, widths or [1.0] * len(heads), strict=True)
    ]
    return Table(title, columns, rows, note)


def tile(label: str, words: str, note: str, state: State = "") -> Tile:
    """A key figure whose number and unit are in words ("12.3 N")."""
    value, _, unit = words.partition(" ")
    return Tile(label, value, unit, note, state)
