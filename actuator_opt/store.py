"""Where files of this package lie: data shipped in the wheel, or the folders of a checkout."""

from __future__ import annotations

import contextlib
import os
from pathlib import Path

from .errors import Diagnostic, InputError

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


def write_text(path: Path, text: str) -> Path:
    """Write a text file whole: aside first, then renamed; no partial file on failure."""
    aside = path.with_name(f".{path.name}.{os.getpid()}.part")
    try:
        aside.write_text(text, encoding="utf-8")
        aside.replace(path)
    except OSError as error:
        with contextlib.suppress(OSError):
            aside.unlink(missing_ok=True)
        reason = f"cannot write: {error.strerror or type(error).__name__}"
        raise InputError(Diagnostic(reason, "choose another file or folder", str(path))) from None
    return path
