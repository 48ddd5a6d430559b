"""Command `docs`: opens the documentation of this installation, without a network."""

from __future__ import annotations

from typing import Annotated

import typer

from ..base.errors import Diagnostic, ExitCode, InputError
from . import streams
from .browser import graphical_browser
from .job import Job
from .options import REPORTS, Json, Quiet, UnusedOut, UnusedSeed

Topic = Annotated[
    list[str] | None,
    typer.Argument(
        metavar="TOPIC",
        help="Metric, PATH, command, material, source, term, or title of a page; default: the "
        "first page.",
    ),
]
NoBrowser = Annotated[
    bool, typer.Option("--no-browser", help="Only print the address of the page.")
]
MISSING = "this installation carries no documentation pages"
REMEDY = (
    "install a wheel of a release, or build them in the sources: "
    "pip install -e '.[docs]' && python docs/build.py"
)


def docs(
    topic: Topic = None,
    no_browser: NoBrowser = False,
    as_json: Json = False,
    quiet: Quiet = False,
    out: UnusedOut = REPORTS,
    seed: UnusedSeed = 0,
) -> ExitCode:
    """Open the documentation at a topic, offline.

    Prints the address of the page and opens it in the browser. Without pages in the installation,
    it prints the answer of `explain`.
    """
    from ..api import explain
    from ..api.documentation import documentation, lead

    job = Job(as_json=as_json, quiet=quiet)
    words = " ".join(topic) if topic else None
    page = documentation(words)
    if page is None:
        fault = Diagnostic(MISSING, REMEDY)
        if words is None:
            raise InputError(fault)
        explanation = explain(words)
        job.answer(explanation.to_dict, lambda: explanation.text(**streams.style()))
        if not quiet:
            streams.err(str(fault))
        return ExitCode.MET
    job.answer(page.to_dict, page.text)
    browser = None if no_browser or as_json else graphical_browser()
    if browser is not None and not browser.open(lead(page)) and not quiet:
        streams.err("The browser did not open: open the address above.")
    return ExitCode.MET
