"""Look through a kept sweep."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from ..errors import Diagnostic, UsageError
from .actuator import plugins_of

if TYPE_CHECKING:
    from ..reporting.explorer import ExplorerFile

ROWS = 5000
"""Designs of a page; of more, an even sample."""


def explore(
    store: str | Path,
    *,
    out: str | Path = "reports",
    study: int | None = None,
    rows: int = ROWS,
    plugins: Sequence[str | Path] = (),
) -> list[ExplorerFile]:
    """Write a kept sweep as one page to look through, and its base design beside it.

    Parameters
    ----------
    store : database of `sweep`
    out : the page's file (``.html``), or a folder
    study : number of the study; default: the newest
    rows : most designs shown; of more, an even sample and the best
    plugins : files with the user's metrics and constraints, as in the sweep

    Returns
    -------
    The page and the design, with their hashes.

    Raises
    ------
    UsageError
        no row is asked for
    InputError
        no such file or study, not a store, one of other models, materials or own metrics, or a
        place where nothing can be written
    """
    from .. import store as files
    from ..reporting.explorer import design_beside, write_explorer
    from ..variants.explored import explored

    if rows < 1:
        raise UsageError(Diagnostic(f"--rows {rows}", "give 1 or more"))
    source, target = Path(store), Path(out)
    if target.suffix.lower() not in (".html", ".htm"):
        target = target / f"{source.stem}_explore.html"
    if str(out) == "-":
        raise UsageError(Diagnostic("--out -: a page is no text to print", "name a file"))
    files.require_folder(target.parent)
    for path in (target, design_beside(target)):
        files.require_apart(path, str(source))
    found = explored(source, study=study, most=rows, plugins=plugins_of(plugins))
    target.parent.mkdir(parents=True, exist_ok=True)
    named = [os.path.relpath(Path(file).resolve(), target.parent.resolve()) for file in plugins]
    return write_explorer(found, target, plugins=named)
