"""Where files of this package lie: data shipped in the wheel, or the folders of a checkout."""

from __future__ import annotations

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
