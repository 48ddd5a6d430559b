"""Commands for recorded runs and for the installation: `runs`, `rerun` of a report, `doctor`."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Annotated

import typer

from ..base import files as store, runs as run_store
from ..base.errors import Diagnostic, ExitCode, UsageError
from . import streams
from .job import Job
from .options import REPORTS, AllPages, Format, Json, NoRecord, Out, PluginFile, Quiet

runs = typer.Typer(
    help="List, show, delete or prune recorded runs. Each optimise, pareto and sweep is recorded.",
    no_args_is_help=True,
)
RunName = Annotated[
    str,
    typer.Argument(
        metavar="RUN",
        help='Id of a run or its first characters, the word "last", or a record file.',
    ),
]


@runs.command("list")
def list_runs(
    design: Annotated[
        str | None,
        typer.Option("--design", metavar="NAME", help="Only runs of this design or file."),
    ] = None,
    command: Annotated[
        str | None, typer.Option("--command", metavar="NAME", help="Only runs of this command.")
    ] = None,
    as_json: Json = False,
    quiet: Quiet = False,
) -> None:
    """List recorded runs, newest first."""
    from .. import api as verbs

    stored, faults = verbs.runs(design=design, command=command)
    rows = [(run.id, dict(run.head)) for run in stored]
    data = [{"id": name} | head for name, head in rows]

    def text() -> str:
        from ..pages.runs import listing
        from ..rendering.terminal import blocks_text

        return blocks_text([listing(rows)], **streams.style())

    job = Job(as_json=as_json, quiet=quiet)
    if not as_json:
        for fault in faults:
            streams.err(str(fault))
    job.answer(
        lambda: {"runs": data, "errors": [fault.to_dict() for fault in faults]},
        text if rows else None,
        remarks=[] if rows else [_no_runs(design, command)],
    )


def _no_runs(design: str | None, command: str | None) -> str:
    """Reason for an empty list of runs, and a remedy."""
    place = run_store.folder()
    if place is None:
        return f"runs are not recorded: {run_store.SWITCH} is set"
    selection = " matching" if design or command else ""
    return f"no{selection} runs are recorded in {place}"


@runs.command("show")
def show_run(
    name: RunName,
    out: Annotated[
        Path | None,
        typer.Option(
            "--out", metavar="DIR", help="Write a figure of the convergence to this folder."
        ),
    ] = None,
    as_json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Show input, result and convergence of a run."""
    from .. import api as verbs

    if out is not None:
        store.require_folder(out)
    run = verbs.read_run(name)
    paths = [] if out is None else verbs.draw_run(run, out)
    Job(as_json=as_json, quiet=quiet).deliver(run, files=[{"path": str(x)} for x in paths])


@runs.command("delete")
def delete_run(name: RunName, as_json: Json = False, quiet: Quiet = False) -> None:
    """Delete one recorded run by its id."""
    from .. import api as verbs

    if name == "last":
        raise UsageError(Diagnostic('"last" cannot be deleted', "write the id of the run"))
    _say_deleted([verbs.delete_run(name)], as_json=as_json, quiet=quiet)


@runs.command("prune")
def prune_runs(
    keep: Annotated[
        int, typer.Option("--keep", min=0, metavar="N", help="Number of newest runs to keep.")
    ],
    as_json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Delete all recorded runs except the newest."""
    from .. import api as verbs

    _say_deleted(verbs.prune_runs(keep=keep), as_json=as_json, quiet=quiet)


def _say_deleted(ids: list[str], *, as_json: bool, quiet: bool) -> None:
    remarks = [f"deleted {name}" for name in ids] or ["nothing to delete"]
    Job(as_json=as_json, quiet=quiet).answer(lambda: {"deleted": ids}, remarks=remarks)


def rerun(
    report: Annotated[
        str, typer.Argument(metavar="REPORT.pdf", help="Report written by actuator-opt.")
    ],
    plugin: PluginFile = None,
    out: Annotated[
        Path | None,
        typer.Option("--out", metavar="DIR", help="Write the report again, to this folder."),
    ] = None,
    all_pages: AllPages = False,
    format: Format = "pdf",
    no_record: NoRecord = False,
    as_json: Json = False,
    quiet: Quiet = False,
) -> ExitCode:
    """Repeat the command of a report from its embedded input."""
    from .. import api as verbs

    job = Job(
        report=out is not None, out=out or REPORTS, all_pages=all_pages, format=format,
        as_json=as_json, quiet=quiet, record=not no_record,
    )  # fmt: skip
    if out is not None:
        store.require_apart(out / f"{Path(report).stem}.pdf", report)
    return job.deliver(job.run(verbs.rerun, report, plugins=plugin or []))


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
