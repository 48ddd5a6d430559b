"""Errors of the program, each in one line: location, fault, remedy.

Every failure that a user can cause is a `UsageError` (exit 2), an `InputError` (exit 3) or an
`Unsolvable` (exit 4); any other exception is a fault of the program (exit 70). These errors carry
`Diagnostic` records, which the terminal prints as plain lines and ``--json`` prints as objects.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import asdict
from enum import IntEnum
from importlib import import_module
from typing import Any

from .dataclass import dataclass


def closest(word: str, names: Iterable[str]) -> str | None:
    """The most similar name by letters, synonyms and meaning; None if none is similar.

    >>> closest("Bore", ["stroke", "bore"]), closest("weight", ["stroke", "mass"])
    ('bore', 'mass')
    """
    from .words import nearest  # needed for faults only

    return next(iter(nearest(word, names, 1)), None)


_TIE = 0.012
"""Difference of the scores of two names that are equally near."""


def remedy(word: str, names: Iterable[str], limit: int = 12, about: str = "") -> str:
    """``did you mean "x"?``, with up to three names of similar meaning; else the valid names.

    Parameters
    ----------
    word : the unknown word
    names : valid names; in a mapping, each with its declaration, whose label or help is its meaning
    limit : largest number of names listed if none is near
    about : words by which to sort this list, such as the key that takes the name

    >>> remedy("strok", ["stroke", "bore"]), remedy("x", ["stroke", "bore"])
    ('did you mean "stroke"?', 'use one of stroke, bore')
    >>> remedy("stiffness", ["stiffness_min", "stiffness_oil", "mass"])
    'did you mean "stiffness_min" or "stiffness_oil"?'
    """
    from .words import by_nearness, ranked  # needed for faults only

    near = ranked(word, names)
    if near:
        best, name, by_letters = near[0]
        equal = [other for score, other, _ in near[:3] if score > best - _TIE]
        quoted = [f'"{other}"' for other in ([name] if by_letters else equal)]
        head = ", ".join(quoted[:-1])
        return f"did you mean {f'{head} or ' if head else ''}{quoted[-1]}?"
    candidates = by_nearness(about, names)
    if not candidates:
        return ""
    more = ", …" if len(candidates) > limit else ""
    return f"use one of {', '.join(candidates[:limit])}{more}"


CONTROLS = r"\x00-\x08\x0b-\x1f\x7f-\x9f\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069\ufeff"
"""Characters that move the cursor or reverse the text direction, for a regular expression."""
_CONTROL = rf"\r(?!\n)|(?!\r)[{CONTROLS}]"


def escaped(text: str, own: str = "") -> str:
    r"""Text with control characters escaped, except tabs and new lines.

    Parameters
    ----------
    text : text to print
    own : control sequences to keep (such as colours), as a regular expression without groups

    >>> print(escaped("\x1b[2J\u202e" "a\tb"))
    \x1b[2J\u202ea	b
    """
    if re.search(f"[{CONTROLS}]", text) is None:  # as nearly always, and in a tenth of the time
        return text
    pattern = f"({own})|{_CONTROL}" if own else f"(?!)()|{_CONTROL}"
    return re.sub(pattern, lambda m: m[1] or m[0].encode("unicode_escape").decode("ascii"), text)


def shown(text: object, limit: int = 60) -> str:
    r"""Fit a text into one line of a message: escape control characters, shorten long text.

    >>> shown("two\nlines")
    'two\\nlines'
    """
    line = "".join(
        c if c.isprintable() else c.encode("unicode_escape").decode("ascii") for c in str(text)
    )
    return line if len(line) <= limit else line[: limit - 1] + "…"


def article(words: str) -> str:
    """A noun with its indefinite article, by its first letter.

    >>> article("oil volume"), article("bore")
    ('an oil volume', 'a bore')
    """
    return f"an {words}" if words[:1].lower() in "aeiou" else f"a {words}"


_LONGEST = 400
"""Largest number of characters of a file name that a message shows."""


class ExitCode(IntEnum):
    """Exit codes of every command; they never change between releases."""

    MET = 0
    MISSED = 1
    USAGE = 2
    BAD_INPUT = 3
    SOLVER_FAILED = 4
    FAULT = 70
    """An internal error; the code is that of EX_SOFTWARE in sysexits.h."""
    INTERRUPTED = 130


EXIT_CODES = {
    ExitCode.MET: "requirements met",
    ExitCode.MISSED: "a requirement missed or infeasible",
    ExitCode.USAGE: "usage",
    ExitCode.BAD_INPUT: "bad input, or a file that cannot be written",
    ExitCode.SOLVER_FAILED: "solver failed",
    ExitCode.FAULT: "a fault of the program (`--debug` shows its traceback)",
    ExitCode.INTERRUPTED: "interrupted",
}
"""Exit codes as listed in the help and the README."""


@dataclass(frozen=True, slots=True)
class Diagnostic:
    """One fault of an input, with its location and its remedy.

    Parameters
    ----------
    message : what is wrong, without a final full stop
    remedy : what to do about it
    file, line, column : location in the source, counted from 1; None without source text
    path : PATH of the value inside the design (``barrel.layup[1].thickness``)
    source : the source line, shown above the caret
    """

    message: str
    remedy: str = ""
    file: str | None = None
    line: int | None = None
    column: int | None = None
    path: str | None = None
    source: str | None = None

    def to_dict(self) -> dict[str, object]:
        """JSON form: file, line, column, path, message, remedy."""
        fields = asdict(self)
        del fields["source"]
        return fields

    def __str__(self) -> str:
        file = None if self.file is None else shown(self.file, _LONGEST)
        place = ":".join(str(p) for p in (file, self.line, self.column) if p is not None)
        head = ": ".join(p for p in (place, self.path or "", self.message) if p)
        first = f"{head}; {self.remedy}" if self.remedy else head
        lines = [first.replace("\r", "\\r").replace("\n", "\\n")]
        if self.source is not None and self.column is not None:
            lines.append(f"    {self.source}")
            lines.append("    " + " " * (self.column - 1) + "^")
        return "\n".join(lines)


@dataclass(frozen=True, slots=True)
class Fault:
    """A fault at a location in a file's tree; `at_key` marks the key instead of the value.

    For a missing key, the location is where the key would be; the message points at its block.
    """

    loc: tuple[str | int, ...]
    message: str
    remedy: str = ""
    at_key: bool = False


class ActuatorError(Exception):
    """Base class of the errors that the library raises on purpose."""

    exit_code = ExitCode.BAD_INPUT

    def __init__(self, diagnostics: Iterable[Diagnostic] | Diagnostic | str) -> None:
        if isinstance(diagnostics, str):
            diagnostics = Diagnostic(diagnostics)
        if isinstance(diagnostics, Diagnostic):
            diagnostics = [diagnostics]
        self.diagnostics: list[Diagnostic] = list(diagnostics)
        super().__init__("\n".join(str(d) for d in self.diagnostics))

    def __str__(self) -> str:
        """The faults, one or more lines each."""
        return "\n".join(str(d) for d in self.diagnostics)


class InputError(ActuatorError):
    """A file, value or PATH that cannot be used (exit 3)."""


class UnknownName(InputError, KeyError):
    """A name that a result does not have, as in ``evaluation["mas"]``."""


class UsageError(ActuatorError):
    """A wrong use of a command or function, such as an unknown option (exit 2)."""

    exit_code = ExitCode.USAGE


class Unsolvable(ActuatorError):
    """The solver found no usable solution (exit 4)."""

    exit_code = ExitCode.SOLVER_FAILED


EXTRAS = {
    "ezdxf": ("DXF", "cad"),
    "openpyxl": ("XLSX", "excel"),
    "pyarrow": ("Parquet", "parquet"),
    "pandas": ("", "pandas"),
    "polars": ("", "polars"),
    "xarray": ("", "xarray"),
    "openmdao": ("", "openmdao"),
}
"""For every optional library, the file format that it writes and the extra that installs it."""


def library(name: str, *, writes: bool = True) -> Any:
    """Import a module of an optional library; raise a one-line error if it is not installed.

    Parameters
    ----------
    name : name of the module
    writes : whether it writes a file; if not, the error does not name the format of the file

    Raises
    ------
    ActuatorError : if the library is not installed
    """
    try:
        return import_module(name)
    except ImportError as missing:
        root = name.partition(".")[0]
        kind, extra = EXTRAS[root]
        written = kind and writes
        message = f"{kind} files need {root}" if written else f"needs {root}"
        fault = Diagnostic(message, f"pip install 'actuator-opt[{extra if written else root}]'")
        raise ActuatorError(fault) from missing
