"""Table of the published and our values of a case in time."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from ..rendering import text
from ..rendering.blocks import Table, text_table
from .papers import percent


class ComparedValue(NamedTuple):
    """A published value beside ours, in the unit of the source."""

    subject: str
    published: float
    ours: float
    unit: str
    place: str
    """Place in the source."""
    digits: int = 4

    @property
    def deviation(self) -> float:
        """Our value divided by the published value, minus 1."""
        return self.ours / self.published - 1


def comparison_table(title: str, rows: Sequence[ComparedValue], note: str = "") -> Table:
    """A row for each value: published, ours, deviation, place."""
    heads = ("value", "published", "ours", "deviation", "place")
    return text_table(
        title,
        heads,
        [
            [
                row.subject,
                *(text.with_unit(text.number(v, row.digits), row.unit) for v in row[1:3]),
                percent(row.deviation),
                row.place,
            ]
            for row in rows
        ],
        note,
        widths=[1.6, 1.0, 1.0, 0.8, 1.4],
    )
