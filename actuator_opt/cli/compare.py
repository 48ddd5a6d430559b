"""`compare`: designs and recorded runs side by side."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from .. import store
from . import streams
from .options import Json, PluginFile, Quiet, Seed, Set
from .shared import assignments


def compare(
    designs: Annotated[
        list[str],
        typer.Argument(metavar="DESIGN", help="Two or more design files or runs (id, last)."),
    ],
    sets: Set = None,
    plugin: PluginFile = None,
    out: Annotated[
        Path | None,
        typer.Option(
            "--out", metavar="DIR", help="Draw mass, compliance and friction into this folder."
        ),
    ] = None,
    optimise: Annotated[
        bool,
        typer.Option("--optimise", help="Optimise each design first; runs and optima stay."),
    ] = False,
    seed: Seed = 0,
    as_json: Json = False,
    quiet: Quiet = False,
) -> None:
    """What differs between designs, and which parts decide."""
    from .. import verbs
    from ..reporting.compare_text import comparison_text

    if out is not None:
        store.require_folder(out)
    with streams.watching():
        found = verbs.compare(
            *designs, set=assignments(sets), plugins=plugin or [], optimise=optimise, seed=seed
        )
    paths = [] if out is None else verbs.draw_comparison(found, out)
    if as_json:
        files: dict[str, Any] = {"files": [{"path": str(path)} for path in paths]} if paths else {}
        streams.out_json(verbs.comparison_json(found) | files)
    elif not quiet:
        streams.out(comparison_text(found, **streams.style()), end="")
        for path in paths:
            streams.err(f"wrote {path}")
