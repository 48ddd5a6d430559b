"""`doctor`: what this installation has, lacks and may write."""

from __future__ import annotations

import sys

import typer

from .. import run_store
from ..errors import ExitCode
from . import streams
from .options import REPORTS, Json, Out, Quiet


def doctor(out: Out = REPORTS, as_json: Json = False, quiet: Quiet = False) -> None:
    """What this installation has, lacks and may write."""
    from .. import verbs

    found = verbs.doctor(out=out, runs=run_store.folder(), terminal=_terminal())
    if as_json:
        streams.out_json(found.to_dict())
    elif not quiet:
        from ..reporting.installation_text import installation_text

        rows = [(x.group, x.name, x.status, x.value, x.remedy) for x in found.findings]
        streams.out(installation_text(rows, **streams.style()), end="")
    if not found.ok:
        raise typer.Exit(ExitCode.MISSED)


def _terminal() -> str:
    """What standard output can show, in words."""
    style, stream = streams.style(), sys.stdout
    encoding = "none" if stream is None else stream.encoding or "ascii"
    parts = [
        f"encoding {encoding}",
        "Unicode signs" if style["unicode"] else "plain ASCII signs",
        "colour" if style["colour"] else "no colour",
        f"{style['width']} columns",
        "a terminal" if stream is not None and stream.isatty() else "no terminal",
    ]
    return ", ".join(parts)
