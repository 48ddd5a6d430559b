"""Plain text tables with aligned columns; JSON text; results as one line and in a notebook."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from importlib import import_module
from typing import Any

from .dataclass import LONGEST_REPR
from .errors import Diagnostic, InputError, shown


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


_RENDERERS = f"{__package__.rpartition('.')[0]}.api.results"
"""Module with the text and the page of every result; imported by name, as it is above this one."""


def headline(kind: str, name: str, words: str) -> str:
    """The repr of a result: one line of at most `LONGEST_REPR` characters.

    >>> headline("Evaluation", "robot knee", "mass 265.1 g, 8 of 10 requirements met")
    "<Evaluation 'robot knee': mass 265.1 g, 8 of 10 requirements met>"
    """
    title = f"{kind} {shown(name, 48)!r}" if name else kind
    return f"<{shown(f'{title}: {words}' if words else title, LONGEST_REPR - 2)}>"


class OneLine:
    """Base class of objects whose repr is one line: class, name and a few words."""

    __slots__ = ()

    def __init_subclass__(cls) -> None:
        """Keep this repr in a data class, which otherwise writes its own."""
        super().__init_subclass__()
        if "__repr__" not in cls.__dict__:
            cls.__repr__ = OneLine.__repr__  # type: ignore[method-assign]

    @property
    def in_short(self) -> tuple[str, str]:
        """The name of the design or file ("" without one), and the state in a few words."""
        raise NotImplementedError

    def __repr__(self) -> str:
        """Class, name and state (`headline`)."""
        return headline(type(self).__name__, *self.in_short)


class Displayed(OneLine):
    """Base class of results: one line as repr, a table when printed, a page in a notebook."""

    __slots__ = ()

    def __str__(self) -> str:
        """The text that the terminal shows, without colours."""
        text: str = import_module(_RENDERERS).text(self, colour=False, unicode=True, width=100)
        return text.rstrip("\n") or repr(self)

    def _repr_html_(self) -> str:
        """The most important parts of the page as HTML, for notebooks."""
        html: str = import_module(_RENDERERS).html(self)
        return html
