"""What the shell gives and gets: standard streams, their width and colour, faults as lines or JSON.

A closed pipe ends the printing, not the command: the exit status stays the command's own. Data
goes out in one piece: Ctrl-C waits until it is written.
"""

from __future__ import annotations

import io
import os
import signal
import sys
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from time import monotonic
from types import FrameType
from typing import TYPE_CHECKING, Any, TextIO

from ..base.errors import Diagnostic, ExitCode, InputError
from ..base.progress import watched
from ..base.suggest import escaped
from ..base.units import whole

if TYPE_CHECKING:
    from ..rendering.console import Style

NARROWEST, WIDEST, USUAL, TERMINAL = 40, 1000, 100, 80
"""Columns: at least, at most, where the output is no terminal, where a terminal does not say."""
PATIENCE, PAUSE = 1.0, 0.2
"""Seconds before progress is told, and between two tellings."""


@dataclass(slots=True)
class _Progress:
    """What this command has done and met so far."""

    printed: bool = False
    """Whether standard output has data already: a second JSON object must not follow."""
    held: bool = False
    """Whether Ctrl-C waits."""
    interrupted: bool = False


_now = _Progress()


def interrupted() -> bool:
    """Whether Ctrl-C was pressed during this command, whatever became of the exception."""
    return _now.interrupted


class Interrupted(KeyboardInterrupt):
    """Ctrl-C. Python ends itself by the signal where a plain one passed the text of an `exec`."""


def _interrupt(number: int, frame: FrameType | None) -> None:
    _now.interrupted = True
    if not _now.held:
        raise Interrupted


def prepare() -> None:
    """Begin a command: remember Ctrl-C, and replace letters that an encoding lacks."""
    _now.printed = _now.held = _now.interrupted = False
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:  # not where it is ignored
        with suppress(ValueError):  # not the main thread
            signal.signal(signal.SIGINT, _interrupt)
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
    width = whole(os.environ.get("COLUMNS", "")) or 0
    if width <= 0:
        width = (os.get_terminal_size(stream.fileno()).columns or TERMINAL) if terminal else USUAL
    return {
        "colour": colour,
        "unicode": encoding.startswith("utf"),
        "width": min(max(width, NARROWEST), WIDEST),
    }


def out(text: str, *, end: str = "\n") -> None:
    """Print data to standard output; control characters but our own colours are spelt out.

    Raises
    ------
    InputError : the disk behind it is full, or the like; a reader who left is no fault
    """
    stream: TextIO | None = sys.stdout
    if stream is None:
        return
    own = ""
    if "\x1b" in text and style()["colour"]:
        from ..rendering.console import PAINT as own  # noqa: N811
    _now.printed = True
    try:
        with _whole():
            _write(stream, escaped(text, own) + end)
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())
    except OSError as error:
        os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())
        reason = f"cannot write to standard output: {error.strerror or type(error).__name__}"
        raise InputError(Diagnostic(reason, "make room, or write elsewhere")) from None


def _write(stream: TextIO, text: str) -> None:
    """Write all of a text, also where a signal or an unbuffered stream makes a write short."""
    buffer = getattr(stream, "buffer", None)
    if buffer is None:
        stream.write(text)
    else:
        errors = stream.errors or "strict"
        left = memoryview(text.replace("\n", os.linesep).encode(stream.encoding, errors))
        stream.flush()
        while left:
            left = left[buffer.write(left) or 0 :]
    stream.flush()


@contextmanager
def _whole() -> Iterator[None]:
    """Hold Ctrl-C back while data is written; it counts afterwards."""
    before, _now.held = _now.interrupted, True
    try:
        yield
    finally:
        _now.held = False
    if _now.interrupted and not before:
        raise Interrupted


def err(text: str) -> None:
    """Print a message to standard error, where there is one; control characters are spelt out."""
    stream: TextIO | None = sys.stderr
    if stream is None:
        return
    try:
        stream.write(escaped(text) + "\n")
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
        words = escaped(what if share is None else f"{what}, {100 * share:.0f} %{left}")
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


def out_json(data: dict[str, Any]) -> None:
    """Print one JSON object."""
    from ..base.plain_json import encoded

    out(encoded(data, indent=1))


def as_json() -> bool:
    """Whether the command line asks for JSON, readable or not."""
    return "--json" in sys.argv[1:]


def faults(found: Iterable[Diagnostic], code: ExitCode) -> ExitCode:
    """Print faults as lines, or as one JSON object under ``--json``; returns `code`.

    Where standard output has data already, or takes none, they are lines on standard error.
    """
    lines = list(found)
    if as_json() and not _now.printed:
        try:
            out_json({"errors": [fault.to_dict() for fault in lines]})
            return code
        except InputError as error:  # standard output is what fails
            lines += error.diagnostics
    for fault in lines:
        err(str(fault))
    return code
