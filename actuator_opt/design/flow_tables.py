"""Flow curves that a file names: read from its folder, or written out in its text."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from ..base.errors import Fault
from .flow_curve import read_flow_table
from .kinds import ValueFault
from .model import Design
from .structure import Loc, child_at
from .yaml_source import Document, parse

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


def self_contained(text: str, design: Design) -> str:
    """Text of a design file in which its flow curve is written out, so that it needs no other file.

    Parameters
    ----------
    text : the file
    design : the design that was read from it, or that it describes
    """
    table = None if design.valve is None else design.valve.flow_curve
    if table is None or not table.file:
        return text
    document = parse(text, table.file)
    span = document.values.get(OF_DESIGN)
    if span is None or child_at(document.data, OF_DESIGN) != table.file:
        return text
    begin = text.rfind("\n", 0, span.start) + 1
    end = text.find("\n", span.end)
    end = len(text) if end < 0 else end
    indent = len(text[begin:]) - len(text[begin:].lstrip(" "))
    rows = table.text.replace("\r\n", "\n").replace("\r", "\n").strip("\n").split("\n")
    alone = text[begin + indent : span.start].strip() == f"{OF_DESIGN[-1]}:"
    after = text[span.end : end].strip()
    if alone and after[:1] in ("", "#") and _literal(rows):
        lines = "".join(f"\n{' ' * (indent + 2)}{row}".rstrip(" ") for row in rows)
        return f"{text[: span.start]}|{text[span.end : end]}{lines}{text[end:]}"
    return text[: span.start] + json.dumps(table.text, ensure_ascii=True) + text[span.end :]


def _literal(rows: Sequence[str]) -> bool:
    """Whether the rows of a table can stand as they are in a literal block of YAML."""
    return bool(rows[0].strip()) and all(
        row.isprintable() and not row.startswith((" ", "\t")) for row in rows
    )
