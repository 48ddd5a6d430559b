"""Where files of this package lie: data shipped in the wheel, or the folders of a checkout."""

from __future__ import annotations

import contextlib
import errno
import os
import sys
import tempfile
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import BinaryIO, TextIO

from .errors import Diagnostic, InputError
from .suggest import closest

_PACKAGE = Path(__file__).resolve().parent


def data_folder(name: str, *, package: Path = _PACKAGE) -> Path:
    """Folder of shipped data (``materials``, ``designs``): packaged data first, else the checkout.

    Parameters
    ----------
    name : name of the folder
    package : folder of the installed package, for tests

    Raises
    ------
    InputError : neither place has the folder

    Notes
    -----
    A wheel carries the folder as ``_data/NAME`` inside the package. A folder beside the package
    counts only where ``pyproject.toml`` shows a checkout: site-packages may hold a stranger's
    ``materials``. Plain paths, because importing ``importlib.resources`` would cost more than
    reading the files does.
    """
    packaged = package / "_data" / name
    if packaged.is_dir():
        return packaged
    checkout = package.parent
    if (checkout / "pyproject.toml").is_file() and (checkout / name).is_dir():
        return checkout / name
    message = f'the data folder "{name}" is missing from this installation'
    raise InputError(Diagnostic(message, "install the package again", str(packaged)))


def read_bytes(source: str | Path, *, most: int, kinds: tuple[str, ...], what: str) -> bytes:
    """The first `most` bytes of a file that a person named.

    Parameters
    ----------
    source : of the file, as the person wrote it; ``"-"`` for standard input
    most : bytes to read
    kinds : endings of such files, to suggest one of a near name
    what : such a file is, in words

    Raises
    ------
    InputError : it is not there, a folder, or not to be read
    """
    path, name = Path(source), str(source)
    if name == "-":
        return sys.stdin.buffer.read(most)
    try:
        with path.open("rb") as stream:
            return stream.read(most)
    except FileNotFoundError:
        raise InputError(Diagnostic("no such file", _near(path, kinds), name)) from None
    except IsADirectoryError:
        raise InputError(Diagnostic("is a folder", f"name a {what} in it", name)) from None
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise InputError(Diagnostic(f"cannot be read: {reason}", "", name)) from None


def _near(path: Path, kinds: tuple[str, ...]) -> str:
    try:
        names = [one.name for one in path.parent.iterdir() if one.suffix in kinds]
    except OSError:
        return "check the path"
    match = closest(path.name, names)
    return f"did you mean {path.parent / match}?" if match else "check the path"


def require_writable(path: Path) -> None:
    """Refuse a file that cannot be written, before the work that would fill it.

    Raises
    ------
    InputError : a folder stands there, its own folder is missing, or permission is; or it is "-"
    """
    folder = path.parent
    if str(path) == "-":
        reason = "is standard output, which carries the results"
    elif path.is_dir():
        reason = "is a folder"
    elif path.exists() and not path.is_file():
        reason = "is no regular file"
    elif not folder.is_dir():
        reason = "its folder does not exist"
    elif not os.access(path if path.exists() else folder, os.W_OK):
        reason = "no permission to write"
    else:
        return
    raise InputError(Diagnostic(reason, "choose another file or folder", str(path)))


def require_folder(folder: Path) -> None:
    """Refuse a folder that cannot be made or written, before the work that would fill it.

    Raises
    ------
    InputError : a file stands in the way, or permission is missing
    """
    place = folder
    while not place.exists() and place != place.parent:
        place = place.parent
    if not place.is_dir():
        reason = f"{place} is a file" if place != folder else "is a file"
    elif not os.access(place, os.W_OK):
        reason = "no permission to write"
    else:
        return
    raise InputError(Diagnostic(reason, "choose a folder with --out", str(folder)))


def require_apart(target: Path, *sources: str) -> None:
    """Refuse to write over a file that is read.

    Raises
    ------
    InputError : the target is one of the sources, or a link to it
    """
    for source in sources:
        with contextlib.suppress(OSError, ValueError):
            if target.samefile(source):
                message = "would be written over what is read"
                raise InputError(Diagnostic(message, "choose another file", str(target)))


def write_text(path: Path, text: str) -> Path:
    """Write a text file whole: aside first, then renamed; no partial file on failure.

    A link stays one: what it points at is written.
    """
    with aside(path) as stream:
        stream.write(text)
    return path.resolve() if path.is_symlink() else path


@contextlib.contextmanager
def aside(path: Path) -> Iterator[TextIO]:
    """A text file to write piece by piece, aside; it is in place once all is written.

    Raises
    ------
    InputError : it cannot be written; nothing partial is left
    """
    with _part(path) as part, part.open("w", encoding="utf-8") as stream:
        yield stream


@contextlib.contextmanager
def aside_bytes(path: Path) -> Iterator[BinaryIO]:
    """As `aside`, of bytes."""
    with _part(path) as part, part.open("wb") as stream:
        yield stream


@contextlib.contextmanager
def _part(path: Path) -> Iterator[Path]:
    """Where to write a file aside; it is renamed once that is done, and gone if it is not."""
    path = path.resolve() if path.is_symlink() else path
    if path.exists() and not path.is_file():
        message = "is a folder" if path.is_dir() else "is no regular file"
        raise InputError(Diagnostic(message, "choose another file or folder", str(path)))
    part = path.with_name(f".{path.name}.{os.getpid()}.part")
    try:
        with writing(path):
            yield part
            part.replace(path)
    finally:  # nothing is left of it once it is in place
        with contextlib.suppress(OSError):
            part.unlink(missing_ok=True)


@contextlib.contextmanager
def writing(path: Path) -> Iterator[None]:
    """Say in one line why a file cannot be written; raises `InputError`."""
    try:
        yield
    except OSError as error:
        reason = f"cannot write: {error.strerror or type(error).__name__}"
        raise InputError(Diagnostic(reason, "choose another file or folder", str(path))) from None


def write_all(folder: Path, contents: Mapping[str, bytes], *, what: str = "the report") -> None:
    """Write every file of a folder aside, then rename all: whole or not at all.

    Parameters
    ----------
    folder : where to; made if missing
    contents : of every file, by name
    what : the files are, in words

    Raises
    ------
    InputError : the folder cannot be written, or a folder stands in a file's way
    """
    parts: list[tuple[Path, Path]] = []
    try:
        folder.mkdir(parents=True, exist_ok=True)
        for name, content in contents.items():
            path = folder / f".{name}.{os.getpid()}.part"
            parts.append((path, folder / name))
            path.write_bytes(content)
        for _, target in parts:
            if target.is_dir():
                raise IsADirectoryError(errno.EISDIR, "a folder stands in the way", str(target))
        for path, target in parts:
            path.replace(target)
    except OSError as error:
        for path, _ in parts:
            with contextlib.suppress(OSError):
                path.unlink(missing_ok=True)
        reason = f"cannot write {what}: {error.strerror or type(error).__name__}"
        fault = Diagnostic(reason, "choose a folder with --out", file=str(folder))
        raise InputError(fault) from None


def unwritable(folder: Path) -> str:
    """Why nothing can be written into a folder, by trying it; "" where it can.

    A folder that is missing is judged by the nearest one above it that is there.
    """
    place = folder.absolute()
    while not place.exists() and place != place.parent:
        place = place.parent
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
