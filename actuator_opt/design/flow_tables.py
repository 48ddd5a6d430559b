"""Flow curves that a file names: read from its folder, or written out in its text."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from ..base.errors import Fault
from .flow_curve import FlowTable, read_flow_table
from .kinds import ValueFault
from .structure import Loc, child_at
from .yaml_source import Document

OF_DESIGN: Loc = ("valve", "flow_curve")
OF_SCENARIO: Loc = ("load", "cylinder", "valve", "flow_curve")


def attached(
    tree: dict[str, Any], loc: Loc, document: Document
) -> tuple[dict[str, Any], list[Fault]]:
    """A tree in which a flow curve at a location is replaced by its table; faults of the table.

    Parameters
    ----------
    tree : dicts and lists of a design or scenario, which stay unchanged
    loc : location of the key
    document : the file, in whose folder the CSV file is
    """
    stated = child_at(tree, loc)
    if not isinstance(stated, str):
        return tree, []
    known = Path(document.file)
    folder = known.parent if known.suffix in (".yaml", ".yml") else Path()
    try:
        table = read_flow_table(stated, folder)
    except ValueFault as fault:
        return tree, [Fault(loc, fault.message, fault.remedy)]
    return _with(tree, loc, table), []


def _with(tree: dict[str, Any], loc: Loc, value: Any) -> dict[str, Any]:
    """A copy of the tree along a location, with a value there."""
    key, *rest = loc
    below = _with(tree[str(key)], tuple(rest), value) if rest else value
    return {**tree, str(key): below}


def self_contained(document: Document, tables: Mapping[Loc, FlowTable | None]) -> str:
    """Text of a file in which every named flow curve is written out, so that it needs no other.

    `tables` are the tables of the file, by the location of their key.
    """
    text = document.text
    spans = [
        (document.values[loc], table)
        for loc, table in tables.items()
        if table is not None and table.file and loc in document.values
    ]
    for span, table in sorted(spans, key=lambda pair: -pair[0].start):
        text = text[: span.start] + json.dumps(table.text, ensure_ascii=False) + text[span.end :]
    return text
