"""Pages of a study: a script's own sheets (a .typ file beside it) with the house's definitions."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any, get_args

from ..base.files import write_all
from .blocks import Block
from .paper import TEMPLATE, plain_blocks, sheets

_MARK = "// ---- sheet ----"
"""Where the template's definitions end and the sheets of a design begin."""


def rounded(study: Mapping[str, Any], digits: int = 7) -> dict[str, Any]:
    """Plain numbers to some digits: the last bits of a machine do not show.

    >>> rounded({"mass": 0.123456789, "rows": (1, None)})
    {'mass': 0.1234568, 'rows': [1, None]}

    Raises
    ------
    ValueError
        a number that JSON lacks
    """
    text = json.dumps(study, allow_nan=False)
    found: dict[str, Any] = json.loads(text, parse_float=lambda x: float(f"{float(x):.{digits}g}"))
    return found


def study_sheets(
    script: Path, study: Mapping[str, Any], shown: Mapping[str, Any]
) -> tuple[bytes, list[bytes]]:
    """A study as PDF and as images of its sheets: the same numbers give the same bytes.

    Parameters
    ----------
    script : the study's file; its sheets stand beside it with the ending .typ
    study : its numbers, attached as JSON
    shown : what the sheets take besides ``numbers``; blocks become plain data
    """
    definitions, mark, _ = TEMPLATE.read_text("utf-8").partition(_MARK)
    assert mark, "the report template no longer says where its definitions end"
    source = definitions + script.with_suffix(".typ").read_text("utf-8")
    numbers = json.dumps(study, indent=1, allow_nan=False)
    data = {name: _plain(value) for name, value in shown.items()}
    return sheets(source.encode(), data | {"numbers": numbers}, timestamp=0)


def _plain(value: Any) -> Any:
    """Blocks, alone or in lists and records, as plain data for a template."""
    if isinstance(value, get_args(Block)):
        return plain_blocks([value])[0]
    if isinstance(value, Mapping):
        return {name: _plain(one) for name, one in value.items()}
    return [_plain(one) for one in value] if isinstance(value, list | tuple) else value


def write_study(pages: tuple[bytes, list[bytes]], folder: Path, name: str) -> int:
    """Write NAME.pdf and the PNG of its first sheet; how many sheets there are."""
    pdf, images = pages
    write_all(folder, {f"{name}.pdf": pdf, f"{name}.png": images[0]})
    return len(images)
