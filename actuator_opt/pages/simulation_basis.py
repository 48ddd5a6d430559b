"""The table of the values on which a simulation is based."""

from __future__ import annotations

from ..rendering.blocks import Block, Column, Medium, Table
from ..rendering.text import pretty, value_text
from ..simulation.basis import Basis


def blocks(basis: Basis, on: Medium = "both") -> list[Block]:
    """Symbol, meaning, value and origin of every value."""
    columns = [
        Column("value", width=1.2, least=24, wraps=True),
        Column("", "right", strong=True),
        Column("from", width=1.4, least=24, breaks=18, wraps=True, style="dim"),
    ]
    rows = [
        [x.quantity.label, value_text(x.quantity, x.value), pretty(x.origin)] for x in basis.values
    ]
    return [Table("Values of the equations", columns, rows, on=on)] if rows else []
