"""Where a page comes from: the design as read, the command, the date."""

from __future__ import annotations

from dataclasses import dataclass

from ..version import VERSION


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

    def run(self) -> dict[str, str]:
        """How the page was made, for its attachment."""
        return {
            "actuator_opt": VERSION,
            "command": self.command,
            "source_name": self.source_name,
            "spec_hash": self.spec_hash,
        } | ({} if self.date is None else {"date": self.date})
