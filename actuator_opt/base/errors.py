"""Errors of the program, one line each: place, fault, remedy.

Every failure that a user can cause is a `UsageError` (exit 2), an `InputError` (exit 3) or an
`Unsolvable` (exit 4); any other exception is a fault of the program (exit 70). These errors carry
`Diagnostic` records, which the terminal prints as plain lines and ``--json`` prints as objects.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import asdict, dataclass
from enum import IntEnum

from .suggest import shown

_LONGEST = 400
"""Characters of a file name that a message shows."""


class ExitCode(IntEnum):
    """Exit codes of every command; they never change between releases."""

    MET = 0
    MISSED = 1
    USAGE = 2
    BAD_INPUT = 3
    SOLVER_FAILED = 4
    FAULT = 70
    """EX_SOFTWARE of sysexits.h: an internal error."""
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
    """One fault of an input, with its place and its remedy.

    Parameters
    ----------
    message : what is wrong, without a final full stop
    remedy : what to do about it
    file, line, column : place in the source, 1-based; None without source text
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
    """A fault with its place in the tree of a file; `at_key` marks the key instead of the value.

    A missing key has the place it would have; the message then points at its block.
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


class InputError(ActuatorError):
    """A file, value or PATH that cannot be used (exit 3)."""


class UsageError(ActuatorError):
    """A command line that cannot be understood (exit 2)."""

    exit_code = ExitCode.USAGE


class Unsolvable(ActuatorError):
    """The solver found no usable solution (exit 4)."""

    exit_code = ExitCode.SOLVER_FAILED
