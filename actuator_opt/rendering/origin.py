"""Where a page comes from: the design as read, the command, the date; what a page begins with."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from ..version import VERSION
from .blocks import clean, short, soft


@dataclass(frozen=True, slots=True)
class Origin:
    """How a page was made.

    Parameters
    ----------
    source_text, source_name : the design file as read: attached to the PDF
    command : the command line, printed and attached
    spec_hash : of the design
    date : ISO date to print, or None for none
    """

    source_text: str
    source_name: str
    command: str
    spec_hash: str
    date: str | None = None

    def heading(self, *, name: str, kind: str) -> dict[str, Any]:
        """What a page begins with, as plain data for the renderers."""
        return {
            "name": soft(name),
            "title": clean(name),
            "short": short(name, 32),
            "kind": kind,
            "version": VERSION,
            "hash": clean(self.spec_hash[:16]),
            "date": "" if self.date is None else clean(self.date),
            "source_name": soft(self.source_name),
            "command": soft(short(self.command, 260), 30),
        }

    def run(self) -> dict[str, str]:
        """How the page was made, for its attachment."""
        return {
            "actuator_opt": VERSION,
            "command": self.command,
            "source_name": self.source_name,
            "spec_hash": self.spec_hash,
        } | ({} if self.date is None else {"date": self.date})


def tile(label: str, words: str, note: str, state: str = "none") -> dict[str, Any]:
    """A key figure: its number and unit in words ("12.3 N"), what to know of it."""
    value, _, unit = words.partition(" ")
    return {
        "label": label,
        "symbol": "",
        "value": value,
        "unit": unit,
        "note": note,
        "state": state,
    }
