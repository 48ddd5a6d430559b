"""Command `studio`: a local page on which the design is the optimum again while a limit moves."""

from __future__ import annotations

import html
import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated

import typer

from ..base.errors import Diagnostic, UsageError
from . import streams
from .browser import graphical_browser
from .job import Job
from .options import REPORTS, DesignFile, Json, Out, PluginFile, Quiet, Seed, Set, Unset

Port = Annotated[
    int | None,
    typer.Option(
        "--port", min=1, max=65535, metavar="N", help="Port on this machine; default: a free one."
    ),
]
NoBrowser = Annotated[
    bool, typer.Option("--no-browser", help="Open no browser; the address is printed anyway.")
]
Offline = Annotated[
    Path | None,
    typer.Option(
        "--offline",
        metavar="FILE.html",
        help="Write one file that works without this program and without network; start no server.",
    ),
]
_OPENING = """<!DOCTYPE html><meta charset="utf-8"><meta name="referrer" content="no-referrer">
<meta http-equiv="refresh" content="0; url={0}"><title>Studio</title><a href="{0}">Open</a>
"""


def studio(
    design: DesignFile,
    offline: Offline = None,
    port: Port = None,
    no_browser: NoBrowser = False,
    sets: Set = None,
    unset: Unset = None,
    plugin: PluginFile = None,
    out: Out = REPORTS,
    seed: Seed = 0,
    as_json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Drag requirements on a page; the best design follows.

    The page shows the section, masses, prices and trade-offs. It saves beside the design, and
    reports to --out. Ctrl-C ends the studio and prints the command that finds the same design.
    With --offline, the page becomes one file for a colleague: it has the models of this design.
    """
    from ..base.files import require_folder
    from ..studio.choices import ChoiceStudio
    from ..studio.server import Server

    if design == "-":
        message = "the studio saves beside the design, so it needs a file"
        raise UsageError(Diagnostic(message, "name a design file"))
    job = Job(design, sets=sets, unset=unset, plugins=plugin, as_json=as_json, quiet=quiet)
    if offline is not None:
        if port is not None:
            message = "--port belongs to a server, and --offline starts none"
            raise UsageError(Diagnostic(message, "leave out one of them"))
        _write_offline(job, offline, seed)
        return
    require_folder(out)
    with Server(port or 0) as server:
        opened = ChoiceStudio.opened(design, set=job.set, plugins=plugin or (), out=out, seed=seed)
        if as_json:
            streams.out_json({"address": server.address})
        else:
            streams.out(f"studio: {server.address}")
            if not quiet:
                streams.err("Keep the address to yourself. Ctrl-C ends the studio.")
        try:
            with _browser("" if no_browser else server.address, quiet):
                server.serve(opened, _fault)
        except KeyboardInterrupt:
            (streams.err if as_json else streams.out)(opened.command())
            raise


def _write_offline(job: Job, target: Path, seed: int) -> None:
    """Write the offline page, or refuse before anything is computed."""
    from ..base.files import require_apart, require_writable
    from ..studio.offline import require_own, write_offline

    if target.suffix not in (".html", ".htm"):
        message = f"--offline {target}: not the name of a page"
        raise UsageError(Diagnostic(message, "write e.g. knee.html"))
    require_writable(target)
    require_apart(target, job.design)
    require_own(target)
    written = job.run(
        write_offline, target, job.design, set=job.set, plugins=job.plugins or (), seed=seed
    )
    files = [written.to_dict()]
    job.answer(lambda: {"files": files}, files=files)


def _fault(error: Exception) -> str:
    """One line for an unexpected exception; with ``--debug`` also its traceback on the terminal."""
    return str(streams.unexpected(error)[0][0])


@contextmanager
def _browser(address: str, quiet: bool) -> Iterator[None]:
    """Open an address in the browser of this desktop, if there is one.

    The browser gets the name of a private file that leads to the address: other users can read
    command lines, and the address contains the key of the page.
    """
    browser = graphical_browser() if address else None
    if browser is None:
        if address and not quiet:
            streams.err("No browser found: open the address above.")
        yield
        return
    number, name = tempfile.mkstemp(prefix="actuator-opt-studio-", suffix=".html")  # mode 0600
    try:
        with os.fdopen(number, "w", encoding="utf-8") as stream:
            stream.write(_OPENING.format(html.escape(address)))
        if not browser.open(Path(name).as_uri()) and not quiet:
            streams.err("The browser did not open: open the address above.")
        yield
    finally:
        Path(name).unlink(missing_ok=True)
