"""Output to the standard streams: width, colour, progress, and faults as lines or JSON.

A closed pipe ends the output but not the command, which keeps its exit status. Data is written
completely before Ctrl-C takes effect. An unexpected exception gives a one-line message and an exit
code.
"""

from __future__ import annotations

import errno
import io
import os
import signal
import sys
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from time import monotonic
from types import FrameType
from typing import TYPE_CHECKING, Any, TextIO

from ..base.dataclass import dataclass
from ..base.errors import Diagnostic, ExitCode, InputError, UsageError, escaped, shown
from ..base.progress import watched
from ..base.units import whole
from ..version import VERSION

if TYPE_CHECKING:
    from ..rendering.console import Style

NARROWEST, WIDEST, USUAL, TERMINAL = 40, 1000, 100, 80
"""Line widths in characters: the smallest and largest allowed; the width without a terminal; the
width of a terminal that does not report its width."""
PATIENCE, PAUSE = 1.0, 0.2
"""Seconds before the first progress report, and between reports."""


@dataclass(slots=True)
class _Progress:
    """State of the streams during a command."""

    printed: bool = False
    """Whether data were already printed to standard output; no second JSON object may follow."""
    held: bool = False
    """Whether Ctrl-C is delayed."""
    interrupted: bool = False


_now = _Progress()


def interrupted() -> bool:
    """Whether Ctrl-C was pressed during this command, even if the exception was lost."""
    return _now.interrupted


class Interrupted(KeyboardInterrupt):
    """Raised on Ctrl-C, because Python ends by signal after a KeyboardInterrupt inside `exec`."""


def _interrupt(number: int, frame: FrameType | None) -> None:
    _now.interrupted = True
    if not _now.held:
        raise Interrupted


def prepare() -> None:
    """Prepare the streams: handle Ctrl-C, and replace characters that the encoding lacks."""
    _now.printed = _now.held = _now.interrupted = False
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:  # unless it is ignored
        with suppress(ValueError):  # not the main thread
            signal.signal(signal.SIGINT, _interrupt)
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="replace")


def style() -> Style:
    """Which text styles standard output can show."""
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


def terminal() -> bool:
    """Whether standard output is a terminal."""
    stream: TextIO | None = sys.stdout
    return stream is not None and stream.isatty()


def out(text: str, *, end: str = "\n") -> None:
    """Print data to standard output; control characters are escaped, except our own colours.

    Raises
    ------
    InputError : if it is not writable, for example on a full disk; a closed pipe is no fault
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
        raise InputError(Diagnostic(reason, "free disk space, or write elsewhere")) from None


def _write(stream: TextIO, text: str) -> None:
    """Write a text completely, even if a signal or an unbuffered stream interrupts the write."""
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
    """Delay Ctrl-C while data is written."""
    before, _now.held = _now.interrupted, True
    try:
        yield
    finally:
        _now.held = False
    if _now.interrupted and not before:
        raise Interrupted


def err(text: str) -> None:
    """Print a message to standard error, if it exists; control characters are escaped."""
    stream: TextIO | None = sys.stderr
    if stream is None:
        return
    try:
        stream.write(escaped(text) + "\n")
        stream.flush()
    except OSError:  # no stream remains for the message
        os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())


def asking() -> bool:
    """Whether questions can be asked: standard input and standard error are a terminal."""
    return all(stream is not None and stream.isatty() for stream in (sys.stdin, sys.stderr))


def ask(question: str) -> str:
    """Ask a question on standard error; return the line that the user types.

    Raises
    ------
    UsageError : the input has ended
    """
    sys.stderr.write(question)
    sys.stderr.flush()
    line = sys.stdin.readline()
    if not line:
        sys.stderr.write("\n")
        raise UsageError(Diagnostic("the input ended, nothing was written", "answer, or use --yes"))
    return line


@contextmanager
def watching() -> Iterator[None]:
    """Show progress on standard error if it is a terminal; remove the line at the end."""
    stream: TextIO | None = sys.stderr
    if stream is None or not stream.isatty() or os.environ.get("TERM") == "dumb":
        yield
        return
    begin = piece = last = monotonic()
    shown, done = "", 0.0

    def show(task: str, share: float | None) -> None:
        nonlocal piece, last, shown, done
        now = monotonic()
        if share is not None:
            piece, done = (now if share < done else piece), share  # a new task begins
        if now < begin + PATIENCE or now < last + PAUSE:
            return
        left = f", {(now - piece) * (1 / share - 1):.0f} s left" if share else ""
        words = escaped(task if share is None else f"{task}, {100 * share:.0f} %{left}")
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
    from ..base.tables import encoded

    out(encoded(data, indent=1))


def as_json() -> bool:
    """Whether the command line has ``--json``, even if it is otherwise invalid."""
    return "--json" in sys.argv[1:]


def faults(diagnostics: Iterable[Diagnostic], code: ExitCode) -> ExitCode:
    """Print faults as lines, or as a JSON object with ``--json``; returns `code`.

    If standard output already has data, or fails, the faults become lines on standard error.
    """
    lines = list(diagnostics)
    if as_json() and not _now.printed:
        try:
            out_json({"errors": [fault.to_dict() for fault in lines]})
            return code
        except InputError as error:  # standard output itself has failed
            lines += error.diagnostics
    for fault in lines:
        err(str(fault))
    return code


DEBUG = "ACTUATOR_OPT_DEBUG"
"""Environment variable that enables tracebacks (any text except "0")."""
_LONGEST = 300
"""Largest number of characters of an exception's text in a message."""
_FULL = {errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EROFS}
"""Error codes of the operating system for a full disk."""


def debugging() -> bool:
    """Whether tracebacks are enabled."""
    return "--debug" in sys.argv[1:] or os.environ.get(DEBUG, "") not in ("", "0")


def unexpected(error: Exception) -> tuple[list[Diagnostic], ExitCode]:
    """One-line message and exit code for an unexpected exception."""
    if debugging():
        import traceback

        err("".join(traceback.format_exception(error)).rstrip())
    if isinstance(error, OSError):
        return [_of_system(error)], ExitCode.BAD_INPUT
    if isinstance(error, MemoryError):
        fault = Diagnostic("out of memory", "use fewer points, or free memory")
        return [fault], ExitCode.SOLVER_FAILED
    from concurrent.futures import BrokenExecutor  # slow to import, needed for faults only

    if isinstance(error, BrokenExecutor):
        message = "a worker process ended before its work was complete"
        remedy = (
            "check the memory, or give fewer --workers; with --store the sweep resumes "
            "from the stored rows"
        )
        return [Diagnostic(message, remedy)], ExitCode.SOLVER_FAILED
    text = shown(f"{type(error).__name__}: {' '.join(str(error).split())}", _LONGEST)
    message = f"internal error of actuator-opt {VERSION}: {text.removesuffix(': ')}"
    remedy = f"please report it{_receiver()} with the command and the traceback (add --debug)"
    return [Diagnostic(message, remedy)], ExitCode.FAULT


def _of_system(error: OSError) -> Diagnostic:
    """Message and remedy for an error of the operating system."""
    reason = error.strerror or type(error).__name__
    if error.filename is not None:
        remedy = "free disk space, or write elsewhere" if error.errno in _FULL else "check the file"
        return Diagnostic(f"cannot be used: {reason}", remedy, str(error.filename))
    try:
        os.getcwd()
    except OSError:
        message = f"the working directory cannot be used: {reason}"
        return Diagnostic(message, "change to a folder that exists")
    return Diagnostic(f"the system refused: {reason}", "check disk space and number of open files")


def _receiver() -> str:
    """Address for bug reports from the package metadata; "" if it has none."""
    from importlib import metadata

    try:
        package = metadata.metadata("actuator-opt")
    except metadata.PackageNotFoundError:
        return ""
    links = dict(
        text.split(", ", 1) for text in package.get_all("Project-URL") or () if ", " in text
    )
    for label in ("issues", "bug tracker", "tracker", "repository", "source", "homepage"):
        for name, link in links.items():
            if name.lower() == label:
                return f" at {link}"
    authors = package.get_all("Author") or package.get_all("Author-email") or ()
    return f" to {authors[0]}".replace(" The ", " the ", 1) if authors else ""
