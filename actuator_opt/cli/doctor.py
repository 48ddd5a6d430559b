"""`doctor`: check the installation, its optional libraries and its folders."""

from __future__ import annotations

import sys

from ..base import runs as run_store
from ..base.errors import ExitCode
from . import streams
from .job import Job
from .options import REPORTS, Json, Out, Quiet


def _terminal() -> str:
    """Capabilities of standard output, in words."""
    style, stream = streams.style(), sys.stdout
    encoding = "none" if stream is None else stream.encoding or "ascii"
    parts = [
        f"encoding {encoding}",
        "Unicode signs" if style["unicode"] else "plain ASCII signs",
        "colour" if style["colour"] else "no colour",
        f"{style['width']} columns",
        "a terminal" if stream is not None and stream.isatty() else "not a terminal",
    ]
    return ", ".join(parts)


def doctor(out: Out = REPORTS, as_json: Json = False, quiet: Quiet = False) -> ExitCode:
    """Check the installation and its optional libraries."""
    from .. import api as verbs

    installation = verbs.doctor(out=out, runs=run_store.folder(), terminal=_terminal())
    return Job(as_json=as_json, quiet=quiet).deliver(installation)
