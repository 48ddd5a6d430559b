"""Save a text beside the design under a plain name, and never over a file unasked."""

from __future__ import annotations

import hashlib
import os
import re
import stat
from pathlib import Path

from ..base import files
from ..base.dataclass import dataclass
from ..base.errors import Diagnostic, InputError, UsageError, shown

NAME = re.compile(r"[A-Za-z0-9_-][A-Za-z0-9._-]{0,79}\.yaml")
"""Names under which the page may save: never a folder, never a hidden file."""
LARGEST = 10_000_000
"""Largest file that may be replaced, in bytes; a design has some thousands."""
_OPENED = ("O_NOFOLLOW", "O_NONBLOCK", "O_BINARY")
"""Flags to open a file that may turn out to be a link or a pipe; some systems lack some."""


@dataclass(frozen=True, slots=True)
class Saved:
    """A file of the studio: its name, its SHA-256, and whether it was written.

    If not, a file of this name exists, and the hash is that of the existing file.
    """

    name: str
    sha256: str
    written: bool


def digest(path: Path) -> str:
    """SHA-256 of a file; a link is not followed.

    Raises
    ------
    InputError : it is missing, a link, no regular file, or too large
    """
    if path.is_symlink():
        raise _refused(path, "is a link")
    try:
        number = os.open(path, os.O_RDONLY | sum(getattr(os, name, 0) for name in _OPENED))
    except OSError as error:
        raise _refused(path, f"cannot be read: {error.strerror}") from None
    if not stat.S_ISREG(os.fstat(number).st_mode):
        os.close(number)
        raise _refused(path, "is not a regular file")
    with open(number, "rb") as stream:
        content = stream.read(LARGEST + 1)
    if len(content) > LARGEST:
        raise _refused(path, "is too large to be a design")
    return hashlib.sha256(content).hexdigest()


def require_name(name: object) -> str:
    """The name, if it is a plain one.

    Raises
    ------
    UsageError : it has a folder, a leading dot, another suffix, or other characters
    """
    if isinstance(name, str) and NAME.fullmatch(name):
        return name
    message = f"{shown(str(name))} is not a plain file name"
    remedy = "write letters, digits, - _ and ., with .yaml at the end, e.g. knee_light.yaml"
    raise UsageError(Diagnostic(message, remedy))


def save_text(folder: Path, name: str, text: str, replacing: str | None = None) -> Saved:
    """Write a text aside and rename it; an existing file is replaced only if its hash is stated.

    Parameters
    ----------
    folder, name : where to write
    text : content
    replacing : SHA-256 of the existing file that may be replaced; None: no file may be

    Raises
    ------
    UsageError : the name is not a plain one
    InputError : it cannot be written, or the name belongs to a link or a folder
    """
    path, content = folder / require_name(name), text.encode()
    if os.path.lexists(path):
        present = digest(path)
        if present != replacing:
            return Saved(name, present, written=False)
    with files.writing(path), files.private_part(folder) as (file, part):
        with open(file.fileno(), "wb", closefd=False) as stream:
            stream.write(content)
        files.publish(file)
        if replacing is None:
            try:
                os.close(os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL))
            except FileExistsError:  # made since the look above
                return Saved(name, digest(path), written=False)
        part.replace(path)
    return Saved(name, hashlib.sha256(content).hexdigest(), written=True)


def _refused(path: Path, reason: str) -> InputError:
    return InputError(Diagnostic(reason, "choose another name", path.name))
