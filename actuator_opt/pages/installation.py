"""The findings of `doctor` as a table; nothing is cut, so that paths can be copied."""

from __future__ import annotations

from collections.abc import Iterable

from ..rendering.blocks import Column, Row, State, Table

_STATUS: dict[str, tuple[str, State]] = {
    "ok": ("ok", "met"),
    "missing": ("not there", "no_reserve"),
    "fault": ("FAULT", "missed"),
}
"""Words and state of a status."""


def findings(entries: Iterable[tuple[str, str, str, str, str]]) -> Table:
    """A table of findings: group, name, status, value and remedy of each."""
    columns = [
        Column("", strong=True, drop=1),
        Column("", style="state"),
        Column(""),
        Column("", width=1.0, wraps=True, least=24),
    ]
    rows, before = [], ""
    for group, name, status, value, remedy in entries:
        words, state = _STATUS[status]
        heading = "" if group == before else group
        rows.append(Row((heading, words, name, f"{value}; {remedy}" if remedy else value), state))
        before = group
    return Table("", columns, rows)
