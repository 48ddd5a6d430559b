"""Unexpected exceptions at the top of the command line: one line, and an exit code."""

from __future__ import annotations

import errno
import os
import sys

from ..base.errors import Diagnostic, ExitCode, shown
from ..version import VERSION
from . import streams

DEBUG = "ACTUATOR_OPT_DEBUG"
"""Environment variable that enables tracebacks (any text but "0")."""

_LONGEST = 300
"""Most characters of an exception that the line shows."""

_FULL = {errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EROFS}
"""Error codes of the operating system for a full disk."""


def debugging() -> bool:
    """Whether tracebacks are enabled."""
    return "--debug" in sys.argv[1:] or os.environ.get(DEBUG, "") not in ("", "0")


def unexpected(error: Exception) -> tuple[list[Diagnostic], ExitCode]:
    """Line and exit code of an unexpected exception."""
    if debugging():
        import traceback

        streams.err("".join(traceback.format_exception(error)).rstrip())
    if isinstance(error, OSError):
        return [_of_system(error)], ExitCode.BAD_INPUT
    if isinstance(error, MemoryError):
        fault = Diagnostic("out of memory", "use fewer points, or free memory")
        return [fault], ExitCode.SOLVER_FAILED
    from concurrent.futures import BrokenExecutor  # slow to import, needed for faults only

    if isinstance(error, BrokenExecutor):
        message = "a worker process ended before its work was complete"
        remedy = "check the memory, or give fewer --workers; a --store resumes from its rows"
        return [Diagnostic(message, remedy)], ExitCode.SOLVER_FAILED
    said = shown(f"{type(error).__name__}: {' '.join(str(error).split())}", _LONGEST)
    message = f"internal error of actuator-opt {VERSION}: {said.removesuffix(': ')}"
    remedy = f"please report it{_receiver()} with the command and the traceback (add --debug)"
    return [Diagnostic(message, remedy)], ExitCode.FAULT


def _of_system(error: OSError) -> Diagnostic:
    """An error of the operating system."""
    reason = error.strerror or type(error).__name__
    if error.filename is not None:
        remedy = "free disk space, or write elsewhere" if error.errno in _FULL else "check the file"
        return Diagnostic(f"cannot be used: {reason}", remedy, str(error.filename))
    try:
        os.getcwd()
    except OSError:
        message = f"the working directory cannot be used: {reason}"
        return Diagnostic(message, "change to a folder that exists")
    return Diagnostic(f"the system refused: {reason}", "check disk space and open files")


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
