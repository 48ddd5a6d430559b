"""Find data shipped in the wheel or in a checkout; read and write the user's files."""

from __future__ import annotations

import contextlib
import errno
import os
import sys
import tempfile
from collections.abc import Iterator, Mapping
from io import FileIO
from math import isfinite
from pathlib import Path
from typing import BinaryIO, Literal, TextIO

from .errors import Diagnostic, InputError, closest

_PACKAGE = Path(__file__).resolve().parents[1]
_CREATE = (
    os.O_WRONLY
    | os.O_CREAT
    | os.O_EXCL
    | getattr(os, "O_NOFOLLOW", 0)  # this module is not available on every system
    | getattr(os, "O_BINARY", 0)
)
_PRIVATE = 0o600
"""Permissions of private files."""
DIGITS = 19
"""Largest number of digits of a whole number in JSON; counts, seeds and times have fewer."""


def data_folder(name: str, *, package: Path = _PACKAGE) -> Path:
    """Folder of shipped data (``materials``, ``designs``): packaged data first, then the checkout.

    Parameters
    ----------
    name : name of the folder
    package : folder of the installed package, for tests

    Raises
    ------
    InputError : the folder is missing in both places

    Notes
    -----
    A wheel carries the folder as ``_data/NAME`` inside the package. A folder beside the package is
    used only if a ``pyproject.toml`` shows that it is a checkout, because site-packages may contain
    an unrelated folder ``materials``. Plain paths are used because importing
    ``importlib.resources`` takes longer than reading the files.
    """
    packaged = package / "_data" / name
    if packaged.is_dir():
        return packaged
    checkout = package.parent
    if (checkout / "pyproject.toml").is_file() and (checkout / name).is_dir():
        return checkout / name
    message = f'the data folder "{name}" is missing from this installation'
    raise InputError(Diagnostic(message, "install the package again", str(packaged)))


def user_folder(kind: Literal["data", "cache"]) -> Path:
    """Folder of this program for data or caches of the user, as the operating system expects it.

    Raises
    ------
    RuntimeError : the home folder is unknown
    """
    name = "actuator-opt"
    if sys.platform == "win32":
        local = os.environ.get("LOCALAPPDATA", "")
        return (Path(local) if local else Path.home() / "AppData" / "Local") / name
    if sys.platform == "darwin":
        library = {"data": "Application Support", "cache": "Caches"}[kind]
        return Path.home() / "Library" / library / name
    stated = os.environ.get(f"XDG_{kind.upper()}_HOME", "")
    if Path(stated).is_absolute():  # the standard requires relative paths to be ignored
        return Path(stated) / name
    return Path.home() / {"data": ".local/share", "cache": ".cache"}[kind] / name


def read_bytes(source: str | Path, *, most: int, kinds: tuple[str, ...], what: str) -> bytes:
    """The first `most` bytes of a file named by the user.

    Parameters
    ----------
    source : path as the user wrote it; ``"-"`` for standard input
    most : largest number of bytes to read
    kinds : usual suffixes of such files; if the file is missing, one with a similar name is
        suggested
    what : kind of file, in words

    Raises
    ------
    InputError : if the file is missing, a folder, or not readable
    """
    path, name = Path(source), str(source)
    if name == "-":
        return _standard_input(most)
    try:
        with path.open("rb") as stream:
            return stream.read(most)
    except FileNotFoundError:
        raise InputError(Diagnostic("no such file", _suggestion(path, kinds), name)) from None
    except IsADirectoryError:
        raise InputError(Diagnostic("is a folder", f"name a {what} in it", name)) from None
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise InputError(
            Diagnostic(f"cannot be read: {reason}", "name another file", name)
        ) from None


def _standard_input(most: int) -> bytes:
    """The first `most` bytes of standard input; raises `InputError`."""
    stream: TextIO | None = sys.stdin
    if stream is None:  # closed by the shell
        raise InputError(Diagnostic("standard input is closed", "name a file", "-"))
    try:
        return stream.buffer.read(most)
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise InputError(
            Diagnostic(f"standard input cannot be read: {reason}", "name a file", "-")
        ) from None


def _suggestion(path: Path, kinds: tuple[str, ...]) -> str:
    """Remedy for a missing file: a file of a similar name, if any."""
    try:
        names = [entry.name for entry in path.parent.iterdir() if entry.suffix in kinds]
    except OSError:
        return "check the path"
    match = closest(path.name, names)
    return f"did you mean {path.parent / match}?" if match else "check the path"


def read_json(text: bytes | str) -> object:
    """Parse untrusted JSON: finite numbers only, whole numbers of at most `DIGITS` digits.

    Raises
    ------
    ValueError : if it is no JSON, or nested too deeply
    """
    import json

    try:
        return json.loads(text, parse_int=_whole, parse_float=_finite, parse_constant=_finite)
    except RecursionError:
        raise ValueError("nested too deeply") from None


def _whole(text: str) -> int:
    if len(text) > DIGITS:
        raise ValueError("too many digits")
    return int(text)


def _finite(text: str) -> float:
    number = float(text)
    if not isfinite(number):
        raise ValueError("not a finite number")
    return number


def require_writable(path: Path) -> None:
    """Refuse an unwritable file before its content is computed.

    Raises
    ------
    InputError : if it is a folder or "-", its folder is missing, or permission is denied
    """
    with writing(path):
        reason = _unwritable_file(path)
    if reason:
        raise InputError(Diagnostic(reason, "choose another file or folder", str(path)))


def _unwritable_file(path: Path) -> str:
    """Why a file cannot be written; "" if it can. Raises `OSError`."""
    folder, reason = path.parent, ""
    if str(path) == "-":
        reason = "is standard output, which carries the results"
    elif path.is_dir():
        reason = "is a folder"
    elif path.exists() and not path.is_file():
        reason = "is not a regular file"
    elif not folder.is_dir():
        reason = "its folder does not exist"
    elif not os.access(path if path.exists() else folder, os.W_OK):
        reason = "no permission to write"
    return reason


def require_folder(folder: Path) -> None:
    """Refuse a folder that cannot be created or written, before its files are computed.

    Raises
    ------
    InputError : a file has this name, or permission is denied
    """
    place = folder
    with writing(folder, "choose a folder with --out"):
        place = _nearest(folder)
    if not place.is_dir():
        reason = f"{place} is a file" if place != folder else "is a file"
    elif not os.access(place, os.W_OK):
        reason = "no permission to write"
    else:
        return
    raise InputError(Diagnostic(reason, "choose a folder with --out", str(folder)))


def _nearest(folder: Path) -> Path:
    """The folder, or its nearest existing parent; raises `OSError`."""
    while not folder.exists() and folder != folder.parent:
        folder = folder.parent
    return folder


def require_apart(target: Path, *sources: str) -> None:
    """Refuse to overwrite a file that the command reads.

    Raises
    ------
    InputError : if the target is one of the sources, or a link to it
    """
    for source in sources:
        with contextlib.suppress(OSError, ValueError):
            if target.samefile(source):
                message = "is an input and would be overwritten"
                raise InputError(Diagnostic(message, "choose another file", str(target)))


def write_text(path: Path, text: str) -> Path:
    """Write a text to a temporary file, then rename it; a failure leaves no partial file.

    A symbolic link is kept: its target is written.
    """
    with aside(path) as stream:
        stream.write(text)
    return path.resolve() if path.is_symlink() else path


@contextlib.contextmanager
def aside(path: Path) -> Iterator[TextIO]:
    """Open a temporary text file for writing in pieces; rename it once complete.

    Raises
    ------
    InputError : if it cannot be written; no partial file remains
    """
    with _part(path) as part, open(part, "w", encoding="utf-8", closefd=False) as stream:
        yield stream


@contextlib.contextmanager
def aside_bytes(path: Path) -> Iterator[BinaryIO]:
    """Like `aside`, for bytes."""
    with _part(path) as part, open(part, "wb", closefd=False) as stream:
        yield stream


@contextlib.contextmanager
def _part(path: Path) -> Iterator[int]:
    """Open a temporary file; rename it once complete, otherwise delete it."""
    path = path.resolve() if path.is_symlink() else path
    if path.exists() and not path.is_file():
        message = "is a folder" if path.is_dir() else "is not a regular file"
        raise InputError(Diagnostic(message, "choose another file or folder", str(path)))
    with writing(path), private_part(path.parent) as (file, part):
        yield file.fileno()
        publish(file)
        part.replace(path)


@contextlib.contextmanager
def private_part(folder: Path) -> Iterator[tuple[FileIO, Path]]:
    """Open a new private file in a folder for writing; delete it afterwards unless renamed.

    Only the user can read it, its name cannot be guessed, and it is never an existing file or
    link: in a shared folder, others can neither read nor redirect the content.

    Raises
    ------
    OSError : if it cannot be created
    """
    part = folder / f".{os.urandom(16).hex()}.part"
    file = FileIO(os.open(part, _CREATE, _PRIVATE), "w")
    try:
        yield file, part
    finally:
        with contextlib.suppress(OSError):
            file.close()
            part.unlink(missing_ok=True)


def make_private(path: Path) -> None:
    """Create an empty private file if none exists; a symbolic link is kept."""
    with contextlib.suppress(OSError):  # the error is reported when the file is opened
        os.close(os.open(os.path.realpath(path), _CREATE, _PRIVATE))


def publish(file: FileIO) -> None:
    """Give the file the usual permissions of new files (from the umask), and close it."""
    mask = os.umask(0o077)
    os.umask(mask)
    if sys.platform != "win32":
        with contextlib.suppress(OSError):  # a file system without permissions
            os.fchmod(file.fileno(), 0o666 & ~mask)
    file.close()


@contextlib.contextmanager
def writing(path: Path, remedy: str = "choose another file or folder") -> Iterator[None]:
    """Explain in one line why a file cannot be written; raises `InputError`."""
    try:
        yield
    except OSError as error:
        reason = f"cannot write: {error.strerror or type(error).__name__}"
        raise InputError(Diagnostic(reason, remedy, str(path))) from None


def write_all(folder: Path, contents: Mapping[str, bytes], *, what: str = "the report") -> None:
    """Write all files of a folder or none: first to temporary files, which are then renamed.

    Parameters
    ----------
    folder : target; created if missing
    contents : content of every file by name
    what : kind of files, in words

    Raises
    ------
    InputError : if the folder is not writable, or a folder has the name of a file
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with contextlib.ExitStack() as stack:
            parts: list[tuple[Path, Path]] = []
            for name, content in contents.items():
                file, part = stack.enter_context(private_part(folder))
                parts.append((part, folder / name))
                with open(file.fileno(), "wb", closefd=False) as stream:
                    stream.write(content)
                publish(file)
            for _, target in parts:
                if target.is_dir():
                    raise IsADirectoryError(errno.EISDIR, "a folder has this name", str(target))
            for part, target in parts:
                part.replace(target)
    except OSError as error:
        reason = f"cannot write {what}: {error.strerror or type(error).__name__}"
        fault = Diagnostic(reason, "choose a folder with --out", file=str(folder))
        raise InputError(fault) from None


def unwritable(folder: Path) -> str:
    """Why a folder cannot be written, found by writing a trial file; "" if it can.

    For a missing folder, its nearest existing parent is tested.
    """
    try:
        place = _nearest(folder.absolute())
    except OSError as error:
        return error.strerror or type(error).__name__
    if not place.is_dir():
        return f"{place} is a file"
    try:
        descriptor, name = tempfile.mkstemp(prefix=".actuator-opt.", suffix=".part", dir=place)
        try:
            os.write(descriptor, b"\n")
        finally:
            os.close(descriptor)
            os.unlink(name)
    except OSError as error:
        return f"{place}: {error.strerror or type(error).__name__}"
    return ""
