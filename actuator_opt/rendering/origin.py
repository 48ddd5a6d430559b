"""Origin of a page (design file, command, date), and the files of a report."""

from __future__ import annotations

from pathlib import Path

from ..base.dataclass import dataclass
from ..version import VERSION
from .blocks import Block, Listing, Page


@dataclass(frozen=True, slots=True)
class Origin:
    """The design file, command and date from which a page was made.

    Parameters
    ----------
    source_text, source_name : the design file as read, attached to the PDF
    command : the command line, printed on the page and attached to the PDF
    spec_hash : hash of the design
    date : ISO date to print, or None
    """

    source_text: str
    source_name: str
    command: str
    spec_hash: str
    date: str | None = None

    def run(self) -> dict[str, str]:
        """Program version, command, file name, hash and date, as data to attach to the PDF."""
        return {
            "actuator_opt": VERSION,
            "command": self.command,
            "source_name": self.source_name,
            "spec_hash": self.spec_hash,
        } | ({} if self.date is None else {"date": self.date})


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
