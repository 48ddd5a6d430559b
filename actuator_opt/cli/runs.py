"""The commands below `actuator-opt runs`, and the report of a recorded run."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from .. import run_store, store
from ..errors import Diagnostic, ExitCode, UsageError
from . import streams
from .options import Json, Quiet

app = typer.Typer(
    help="Recorded runs: list, show, delete, prune. Each optimise, pareto and sweep leaves one.",
    no_args_is_help=True,
)
RunName = Annotated[
    str,
    typer.Argument(metavar="RUN", help="Id of a run, the beginning of one, last, or its file."),
]


@app.command("list")
def list_runs(
    design: Annotated[
        str | None, typer.Option("--design", metavar="NAME", help="Only of this design or file.")
    ] = None,
    command: Annotated[
        str | None, typer.Option("--command", metavar="NAME", help="Only of this command.")
    ] = None,
    as_json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Recorded runs, the newest first."""
    from .. import verbs

    found, faults = verbs.runs(design=design, command=command)
    if as_json:
        rows = [{"id": one.id} | dict(one.head) for one in found]
        streams.out_json({"runs": rows, "errors": [fault.to_dict() for fault in faults]})
        return
    for fault in faults:
        streams.err(str(fault))
    if found and not quiet:
        from ..reporting.runs_text import runs_table

        streams.out(runs_table([(one.id, one.head) for one in found], **streams.style()), end="")
    elif not quiet:
        streams.err(_nothing(design, command))


def _nothing(design: str | None, command: str | None) -> str:
    place = run_store.folder()
    if place is None:
        return f"no runs are recorded: {run_store.SWITCH} is set"
    what = " like that" if design or command else ""
    return f"no runs{what} are recorded in {place}"


@app.command("show")
def show_run(
    name: RunName,
    out: Annotated[
        Path | None,
        typer.Option("--out", metavar="DIR", help="Draw its convergence into this folder."),
    ] = None,
    as_json: Json = False,
    quiet: Quiet = False,
) -> None:
    """What was asked, what came out, how the search went."""
    from .. import verbs

    if out is not None:
        store.require_folder(out)
    found = verbs.read_run(name)
    paths = [] if out is None else verbs.draw_run(found, out)
    if as_json:
        files: dict[str, Any] = {"files": [{"path": str(path)} for path in paths]} if paths else {}
        streams.out_json(found.to_dict() | files)
    elif not quiet:
        from ..reporting.runs_text import run_text

        with verbs.sound(found):
            told = run_text(found.id, found.head, found.body, **streams.style())
        streams.out(told, end="")
        for path in paths:
            streams.err(f"wrote {path}")


@app.command("delete")
def delete_run(name: RunName, as_json: Json = False, quiet: Quiet = False) -> None:
    """Delete one recorded run by its id."""
    from .. import verbs

    if name == "last":
        raise UsageError(Diagnostic('"last" is not deleted', "write the id of the run"))
    _say_deleted([verbs.delete_run(name)], as_json=as_json, quiet=quiet)


@app.command("prune")
def prune_runs(
    keep: Annotated[
        int, typer.Option("--keep", min=0, metavar="N", help="Keep the newest N runs.")
    ],
    as_json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Delete all recorded runs but the newest."""
    from .. import verbs

    _say_deleted(verbs.prune_runs(keep=keep), as_json=as_json, quiet=quiet)


def _say_deleted(found: list[str], *, as_json: bool, quiet: bool) -> None:
    if as_json:
        streams.out_json({"deleted": found})
    elif not quiet:
        for name in found:
            streams.err(f"deleted {name}")
        if not found:
            streams.err("nothing to delete")


def reported(
    name: str, sets: list[str] | None, plugins: list[Path] | None, out: Path, date: str | None
) -> tuple[list[dict[str, Any]], ExitCode]:
    """Report a recorded run: its files and the exit status; what differs from then is told."""
    from .. import verbs
    from ..optimisation.pareto_result import ParetoFront
    from .optimise import outcome_of
    from .pareto import outcome_of as outcome_of_front

    if sets:
        raise UsageError(Diagnostic("--set: a run is reported as it was", "name a design instead"))
    found = verbs.restore(name, plugins=plugins or [])
    for doubt in found.doubts:
        streams.err(doubt)
    with streams.watching():
        files = [x.to_dict() for x in verbs.report_run(found, folder=out, date=date)]
    if found.run.head["kind"] == "sweep":
        return files, ExitCode.MET if found.run.head["met"] else ExitCode.MISSED
    if isinstance(found.result, ParetoFront):
        if not files:
            streams.err(found.result.sentence)
        return files, outcome_of_front(found.result)
    return files, outcome_of(found.optimisation)
