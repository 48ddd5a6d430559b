"""A page as data: verdict, key figures, a large figure, and blocks from top to bottom.

`pages` builds a `Page`; `paper`, `terminal` and `html` render it. The field `on` of a block names
its medium: paper, terminal or both; HTML shows the same blocks as paper.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import field, replace
from pathlib import Path
from typing import Any, Literal, TypeAlias

from ..base.dataclass import dataclass
from ..base.errors import CONTROLS
from ..version import VERSION
from .chart import Curve, Panel
from .ink import Ink
from .text import STATUS_WORDS


@dataclass(frozen=True, slots=True, eq=False)
class Chart:
    """A block with panels side by side; a sequence of panels forms a column.

    Parameters
    ----------
    title : title of the block
    panels : panels and columns of panels, from the left. In a column, a picture (`Ink`) is placed
        below the panels
    note : sentences below the chart
    instead : block that the terminal shows instead
    height : height on paper [mm]
    widths : relative widths of the columns; default: equal
    key : curves whose names are shown once, above all panels
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
"""State of a requirement, a check or a whole page; empty if there is nothing to judge."""
Medium: TypeAlias = Literal["both", "paper", "terminal"]
Align: TypeAlias = Literal["left", "center", "right"]

_PIECES = re.compile(r"(?:[^./=\[]|[./=\[]+(?=[0-9]))*(?:[./=\[]+|$)", re.DOTALL)
_NAMES = re.compile(r"[^_]*(?:_+|$)")
_NAME = 18
"""Largest number of characters of a name that fits into any column."""
_WORDS = re.compile(r"\s*\S+\s*|\s+")
_CONTROL = re.compile(rf"[{CONTROLS}]")


def clean(text: str) -> str:
    """Printable text; control and direction characters become code points, ``⟨U+0007⟩``."""
    return _CONTROL.sub(lambda m: f"⟨U+{ord(m[0]):04X}⟩", text)


_PAPER = re.compile(
    r"[^\n\t\u0020-\u007e\u00a0-\u02af\u0370-\u052f\u1e00-\u1eff\u2010-\u2029\u202f-\u205e"
    r"\u2070-\u209c\u20a0-\u20b5\u2100-\u2311\u2500-\u26b8\u2701-\u27be\u27e8\u27e9]"
)
"""Pattern of characters that the typeface lacks: all but Latin, Greek, Cyrillic and technical
signs."""


def printable(text: str) -> str:
    """Text that the typeface can draw; other characters become code points, ``⟨U+4E2D⟩``."""
    if text.isascii():
        return text
    return _PAPER.sub(lambda m: f"⟨U+{ord(m[0]):04X}⟩", text)


def soft(text: str, longest: int = 14, *, name: int = _NAME) -> str | list[str]:
    """A text whose words of more than `longest` letters may break after ``. / = [``.

    A single name of more than `name` letters may also break after ``_``. If it is still wider than
    the column, it may break anywhere.

    >>> soft("materials.steel_42crmo4.density", 22)
    ['materials.', 'steel_42crmo4.', 'density']
    """
    text = clean(text)
    pieces: list[str] = [""]
    for word in _WORDS.findall(text):
        if len(word.rstrip()) <= longest:
            pieces[-1] += word
            continue
        first, *rest = _pieces(word, max(longest, name))
        pieces[-1] += first
        pieces += rest
    return text if len(pieces) == 1 else pieces


def _pieces(word: str, most: int) -> Iterator[str]:
    """Parts of a word between which a line may break.

    A break after ``_`` is only allowed in names of more than `most` letters.
    """
    for part in filter(None, _PIECES.findall(word)):
        if len(part.rstrip()) <= most:
            yield part
            continue
        for name in filter(None, _NAMES.findall(part)):
            yield from (name[k : k + _NAME] for k in range(0, len(name), _NAME))


def short(text: str, length: int) -> str:
    """A text cut to `length` letters with an ellipsis."""
    text = clean(text)
    return text if len(text) <= length else text[: length - 1].rstrip() + "…"


@dataclass(frozen=True, slots=True)
class Status:
    """A state with its mark and words; without words, the usual words of the state."""

    state: State
    text: str = ""

    @property
    def words(self) -> str:
        """The words shown beside the mark."""
        return self.text or STATUS_WORDS[self.state]


@dataclass(frozen=True, slots=True)
class Bar:
    """A margin as a bar, full at 100 %; a reserve is to the right of the zero mark.

    A violation is to the left.
    """

    margin: float | None
    met: bool = True


@dataclass(frozen=True, slots=True)
class Share:
    """A share as a bar from zero to one."""

    value: float


@dataclass(frozen=True, slots=True)
class Slot:
    """Position of a value between its bounds, from 0 to 1; `at` is the bound that it reached."""

    place: float
    at: str = ""


FARTHEST = 0.3
"""Relative change at which the bar of a `Reach` has its full length; ticks mark a third of it."""


@dataclass(frozen=True, slots=True)
class Reach:
    """Bar that shows how far a value may change before a result (such as a price) no longer holds.

    `change` is this relative change; None if the result holds over the whole tested range. `met` is
    False if tests within that range show that the result is inaccurate.
    """

    change: float | None
    met: bool = True


@dataclass(frozen=True, slots=True)
class Flag:
    """Words in a cell that are emphasised if `raised` is True."""

    text: str
    raised: bool


Cell: TypeAlias = str | list[str] | Status | Bar | Share | Slot | Reach | Flag
"""Content of a table cell: a text, pieces of text between which a line may break, or a mark."""


@dataclass(frozen=True, slots=True)
class Column:
    """A column of a table, on paper and on the terminal.

    Parameters
    ----------
    head : text above the column; its line breaks apply only on paper
    align : alignment of its cells
    width : "auto", a share of the remaining width (number), or ``"12mm"``; a column with a share
        shrinks on a narrow terminal
    breaks : words with more letters than this may break; 0: never
    wraps : whether a cell that is too wide for the terminal is wrapped; otherwise it is cut
    mono, strong : whether the type on paper is monospaced, and bold; strong is bold on the
        terminal, too
    least : minimum width in characters to which the column may shrink on the terminal
    drop : on a narrow terminal, columns with the highest number are dropped first; 0: never
    style : on the terminal: "bold", "dim", a colour, or "state" (the colour of the row's state)
    on : medium that shows the column
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
        """Whether the width of the column is a share of the remaining width."""
        return not isinstance(self.width, str)


@dataclass(frozen=True, slots=True)
class Row:
    """A row of a table; its state colours the cells in columns with the style "state"."""

    cells: Sequence[Cell]
    state: State = ""


@dataclass(frozen=True, slots=True)
class Table:
    """A table whose rows may have a state; a horizontal line precedes the last `total` rows.

    On the terminal, `headless` or an empty title omits the title. If every head is empty, the
    terminal shows no line of heads. A table with `repeat` that is too wide is shown in parts; each
    part begins with the first `repeat` columns.
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
        """The table in parts no wider than `room`; the `widths` of columns include their gaps."""
        if not self.repeat or sum(widths) <= room:
            return [self]
        first, remaining = list(range(self.repeat)), list(range(self.repeat, len(self.columns)))
        parts = []
        while remaining:
            part = [*first, remaining.pop(0)]
            while remaining and sum(widths[k] for k in (*part, remaining[0])) <= room:
                part.append(remaining.pop(0))
            parts.append(self._of(part))
        return parts

    def _of(self, columns: Sequence[int]) -> Table:
        """The table with only these columns."""
        rows = [
            replace(row, cells=[row.cells[k] for k in columns])
            if isinstance(row, Row)
            else [row[k] for k in columns]
            for row in self.rows
        ]
        return replace(self, columns=[self.columns[k] for k in columns], rows=rows, repeat=0)


@dataclass(frozen=True, slots=True)
class Drawing:
    """A picture (`Ink`) with a title and a note; the terminal shows `instead` in its place."""

    title: str
    ink: Ink
    note: str = ""
    instead: TerminalFigure | Table | None = None


@dataclass(frozen=True, slots=True)
class TerminalFigure:
    """A curve drawn with characters on the terminal, with a limit line and words at both ends."""

    title: str
    points: Sequence[tuple[float, float]]
    level: float | None = None
    ends: tuple[str, str] | None = None
    height: int = 7
    note: str = ""


@dataclass(frozen=True, slots=True)
class Notes:
    """Sentences under a title; `style` and `headless` (no title) apply only to the terminal."""

    title: str
    items: Sequence[str]
    note: str = ""
    headless: bool = False
    style: str = ""
    on: Medium = "both"


@dataclass(frozen=True, slots=True)
class Listing:
    """A file as text with line numbers, in monospace type; only on paper and in HTML."""

    title: str
    text: str


@dataclass(frozen=True, slots=True)
class Pair:
    """Blocks side by side on paper, below each other on the terminal.

    If `tight`, the terminal shows them without blank lines between, and side by side where it is
    wide enough.
    """

    sides: Sequence[Sequence[Block]]
    tight: bool = False


Block: TypeAlias = Table | Drawing | Chart | TerminalFigure | Notes | Listing | Pair


@dataclass(frozen=True, slots=True)
class Verdict:
    """Badge at the top of a page: state, words in capitals, plain lines, and cautions in amber."""

    state: State
    text: str
    lines: Sequence[str] = ()
    cautions: Sequence[str] = ()


@dataclass(frozen=True, slots=True)
class Tile:
    """A key figure: label, number with unit, and note."""

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
    name, kind : title of the page, and kind of page
    verdict, sentence : the badge, and the sentences beside it
    tiles : up to five key figures
    hero : function that draws the large figure below them, for an available height [mm]
    blocks : the blocks from top to bottom
    scale : scale of the large figure, for the title block
    items : numbered parts of the large figure: (number, part, material)
    design : name in the title block; default: `name`
    least : minimum height of the large figure [mm]; if necessary, blocks move to the next sheet
    lists_input : whether the text of the design file follows at the end
    summary : titles of the tables in a summary; default: the first two
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
    summary: Sequence[str] = ()


def text_table(
    title: str,
    heads: Sequence[str],
    rows: Sequence[Sequence[Cell]],
    note: str = "",
    widths: Sequence[float | str] = (),
) -> Table:
    """A table of texts whose columns have equal widths, or `widths`; long words may break."""
    columns = [
        Column(head, "left", width, breaks=14)
        for head, width in zip(heads, widths or [1.0] * len(heads), strict=True)
    ]
    return Table(title, columns, rows, note)


def tile(label: str, words: str, note: str, state: State = "") -> Tile:
    """A key figure from a text that contains number and unit ("12.3 N")."""
    value, _, unit = words.partition(" ")
    return Tile(label, value, unit, note, state)


@dataclass(frozen=True, slots=True)
class Origin:
    """The design file, command and date from which a page was made.

    Parameters
    ----------
    source_text, source_name : the design file as read, attached to the PDF
    command : the command line, printed on the page and attached to the PDF
    spec_hash : hash of the design
    date : ISO date to print, or None
    files : texts of the cycle files that the design names, by name, attached to the PDF
    """

    source_text: str
    source_name: str
    command: str
    spec_hash: str
    date: str | None = None
    files: Mapping[str, str] = field(default_factory=dict)

    def run(self) -> dict[str, Any]:
        """Program version, command, file name, hash, date, files, as data to attach to the PDF."""
        run: dict[str, Any] = {
            "actuator_opt": VERSION,
            "command": self.command,
            "source_name": self.source_name,
            "spec_hash": self.spec_hash,
        }
        run |= {} if self.date is None else {"date": self.date}
        return run | ({"files": dict(self.files)} if self.files else {})


@dataclass(frozen=True, slots=True)
class AttachedFile:
    """A text to attach to the PDF of a report, besides the input.

    Parameters
    ----------
    name : plain name of the file
    media : media type, such as "text/html"
    content : its text
    about : what it is, in words
    """

    name: str
    media: str
    content: str
    about: str


@dataclass(frozen=True, slots=True)
class ReportFile:
    """A file of a report, with its hash and its number of sheets."""

    path: Path
    sha256: str
    pages: int

    def to_dict(self) -> dict[str, object]:
        """The JSON form."""
        return {"path": str(self.path), "sha256": self.sha256, "pages": self.pages}


def with_input(page: Page, origin: Origin | None) -> list[Block]:
    """The blocks of a page; at the end the text of the design file if the page lists its input."""
    blocks = [*page.blocks]
    if page.lists_input and origin is not None:
        blocks.append(Listing(f"Input: {origin.source_name}", origin.source_text))
    return blocks
