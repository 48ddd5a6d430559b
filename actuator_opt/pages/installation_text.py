"""What `doctor` found, as lines for the terminal; nothing is cut, as paths are to be copied."""

from __future__ import annotations

import textwrap
from collections.abc import Iterable

from ..rendering.console import Console

_WORDS = {"ok": "ok", "missing": "not there", "fault": "FAULT"}
_STYLE = {"ok": "green", "missing": "yellow", "fault": "red"}
_MARK, _NAME = 11, 14
_PATIENT = 24
"""Least columns for the text itself."""


def installation_text(
    rows: Iterable[tuple[str, str, str, str, str]],
    *,
    colour: bool = False,
    unicode: bool = True,
    width: int = 100,
) -> str:
    """Lines of findings: group, name, status, value and remedy of each."""
    console = Console(colour, unicode, width)
    lines: list[str] = []
    before = ""
    room = max(width - _MARK - _NAME - 4, _PATIENT)
    for group, name, status, value, remedy in rows:
        if group != before:
            lines += ["", console.heading(group)] if lines else [console.heading(group)]
            before = group
        told = f"{value}; {remedy}" if remedy else value
        first, *more = textwrap.wrap(
            console.say(told), room, break_long_words=False, break_on_hyphens=False
        ) or [""]
        mark = console.paint(_WORDS[status].ljust(_MARK), _STYLE[status])
        lines.append(f"  {mark}{console.say(name).ljust(_NAME)}  {first}".rstrip())
        lines += [f"{'':{_MARK + _NAME + 4}}{line}" for line in more]
    return "\n".join(lines) + "\n"
