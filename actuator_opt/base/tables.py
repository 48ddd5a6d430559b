"""Plain text tables with aligned columns; JSON text; results shown in a notebook.

A notebook shows a result as the HTML page of that result.
"""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any

from .errors import Diagnostic, InputError


def aligned(rows: Sequence[Sequence[str]], *, right: Sequence[int] = ()) -> str:
    """Join rows of cells into lines with aligned columns; `right` lists right-aligned columns.

    >>> print(aligned([["bore", "25"], ["rod", "9.5"]], right=[1]))
    bore   25
    rod   9.5
    """
    widths = [max(len(row[i]) for row in rows) for i in range(len(rows[0]))] if rows else []
    lines = []
    for row in rows:
        cells = [
            cell.rjust(width) if i in right else cell.ljust(width)
            for i, (cell, width) in enumerate(zip(row, widths, strict=True))
        ]
        lines.append("  ".join(cells).rstrip())
    return "\n".join(lines)


LOST = "not_finite"
"""Key under which a JSON object lists the numbers that are null because they are not finite."""


def encoded(data: Mapping[str, Any], **style: Any) -> str:
    """JSON text of an object.

    Parameters
    ----------
    data : plain data
    style : options of `json.dumps` (``indent``, ``separators``, ``sort_keys``, ``ensure_ascii``)

    Raises
    ------
    InputError : if the data are nested too deeply

    Notes
    -----
    RFC 8259, section 6: "Infinity and NaN are not permitted".

    >>> encoded({"a": 1.5, "b": [float("inf")]})
    '{"a": 1.5, "b": [null], "not_finite": {"b[0]": "unbounded"}}'
    """
    try:
        try:
            return json.dumps(data, allow_nan=False, **style)
        except ValueError:
            lost: dict[str, str] = {}
            finite = _finite(data, "", lost)
            if not lost:
                raise
            return json.dumps(finite | {LOST: lost}, allow_nan=False, **style)
    except RecursionError:
        raise InputError(Diagnostic("the data is nested too deeply", "reduce its depth")) from None


def _finite(value: Any, path: str, lost: dict[str, str]) -> Any:
    if isinstance(value, float) and not math.isfinite(value):
        lost[path] = "not computable" if math.isnan(value) else "unbounded"
        return None
    if isinstance(value, Mapping):
        start = f"{path}." if path else ""
        return {key: _finite(below, f"{start}{key}", lost) for key, below in value.items()}
    if isinstance(value, (list, tuple)):
        return [_finite(below, f"{path}[{k}]", lost) for k, below in enumerate(value)]
    return value


_RENDERERS: list[Callable[[object], str]] = []


def show_by(renderer: Callable[[object], str]) -> None:
    """Register the function that turns a result into HTML."""
    _RENDERERS[:] = [renderer]


class Displayed:
    """Base class of results that a notebook shows as their page."""

    __slots__ = ()

    def _repr_html_(self) -> str | None:
        """The page as HTML; None if no function for it is registered."""
        return _RENDERERS[0](self) if _RENDERERS else None
