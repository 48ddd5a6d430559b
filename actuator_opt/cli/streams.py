"""What the shell gives and gets: standard streams, their width and colour, faults as lines or JSON.

A closed pipe ends the printing, not the command: the exit status stays the command's own.
"""

from __future__ import annotations

import io
import os
import sys
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from time import monotonic
from typing import Any, TextIO, TypedDict

from ..errors import Diagnostic, ExitCode, InputError
from ..progress import watched

NARROWEST, USUAL, TERMINAL = 40, 100, 80
"""Columns: at least, where the output is no terminal, and where a terminal does not say."""
PATIENCE, PAUSE = 1.0, 0.2
"""Seconds before progress is told, and between two tellings."""


class Style(TypedDict):
    """How text may look: colour codes, Unicode signs, columns."""

    colour: bool
    unicode: bool
    width: int


def prepare() -> None:
    """Let the streams replace letters their encoding lacks instead of failing."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="replace")


def style() -> Style:
    """What standard output can show."""
    stream: TextIO | None = sys.stdout
    if stream is None:
        return {"colour": False, "unicode": False, "width": USUAL}
    terminal = stream.isatty()
    colour = terminal and "NO_COLOR" not in os.environ and os.environ.get("TERM") != "dumb"
    encoding = (stream.encoding or "ascii").lower().replace("-", "")
    stated = os.environ.get("COLUMNS", "")
    width = int(stated) if stated.isdecimal() else 0
    if width <= 0:
        width = (os.get_terminal_size(stream.fileno()).columns or TERMINAL) if terminal else USUAL
    return {
        "colour": colour,
        "unicode": encoding.startswith("utf"),
        "width": max(width, NARROWEST),
    }


def out(text: str, *, end: str = "\n") -> None:
    """Print data to standard output.

    Raises
    ------
    InputError : the disk behind it is full, or the like; a reader who left is no fault
    """
    stream: TextIO | None = sys.stdout
    if stream is None:
        return
    try:
        stream.write(text + end)
        stream.flush()
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())
    except OSError as error:
        os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())
        reason = f"cannot write to standard output: {error.strerror or type(error).__name__}"
        raise InputError(Diagnostic(reason, "make room, or write elsewhere")) from None


def err(text: str) -> None:
    """Print a message to standard error, where there is one."""
    stream: TextIO | None = sys.stderr
    if stream is None:
        return
    try:
        stream.write(text + "\n")
        stream.flush()
    except OSError:  # nowhere left to say it
        os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())


@contextmanager
def watching() -> Iterator[None]:
    """Tell long work on standard error, where that is a terminal; nothing of it stays."""
    stream: TextIO | None = sys.stderr
    if stream is None or not stream.isatty() or os.environ.get("TERM") == "dumb":
        yield
        return
    begin = piece = last = monotonic()
    shown, done = "", 0.0

    def show(what: str, share: float | None) -> None:
        nonlocal piece, last, shown, done
        now = monotonic()
        if share is not None:
            piece, done = (now if share < done else piece), share  # a new piece of work begins
        if now < begin + PATIENCE or now < last + PAUSE:
            return
        left = f", {(now - piece) * (1 / share - 1):.0f} s left" if share else ""
        words = what if share is None else f"{what}, {100 * share:.0f} %{left}"
        stream.write(f"\r{words.ljust(len(shown))}")
        stream.flush()
        last, shown = now, words

    try:
        with watched(show):
            yield
    finally:
        if shown:
            stream.write(f"\r{' ' * len(shown)}\r")
            stream.flush()


def out_json(data: Any) -> None:
    """Print one JSON object; numbers that JSON lacks are a fault of ours."""
    import json

    out(json.dumps(data, ensure_ascii=True, allow_nan=False, indent=1))


def as_json() -> bool:
    """Whether the command line asks for JSON, readable or not."""
    return "--json" in sys.argv[1:]


def faults(found: Iterable[Diagnostic], code: ExitCode) -> ExitCode:
    """Print faults as lines, or as one JSON object under ``--json``; returns `code`."""
    lines = list(found)
    if as_json():
        try:
            out_json({"errors": [fault.to_dict() for fault in lines]})
            return code
        except InputError as error:  # standard output is what fails
            lines += error.diagnostics
    for fault in lines:
        err(str(fault))
    return code
