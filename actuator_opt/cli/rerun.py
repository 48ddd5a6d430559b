"""`rerun`: the command of a report once more, from the input that the PDF carries."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from .. import store
from ..errors import ExitCode
from . import pareto, streams
from .optimise import outcome_of, recorded
from .options import Json, NoRecord, PluginFile, Quiet
from .shared import check_targets, say_files

if TYPE_CHECKING:
    from ..verbs import Rerun


def rerun(
    report: Annotated[str, typer.Argument(metavar="REPORT.pdf", help="Report of actuator-opt.")],
    plugin: PluginFile = None,
    out: Annotated[
        Path | None,
        typer.Option("--out", metavar="DIR", help="Write the report into this folder again."),
    ] = None,
    no_record: NoRecord = False,
    as_json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Run the command of a report again, from the input it carries."""
    from .. import verbs
    from ..optimisation.pareto_result import ParetoFront
    from ..optimisation.result import Optimisation

    check_targets(out, None)
    if out is not None:
        store.require_apart(out / f"{Path(report).stem}.pdf", report)
    with streams.watching():
        found = verbs.rerun(report, plugins=plugin or [])
    files = [] if out is None else _written(found, out)
    subject = found.subject
    if isinstance(subject, Optimisation):
        code = outcome_of(subject)
        if not no_record:
            recorded(subject, found.actuator, found.command, found.date, list(found.tables))
    elif isinstance(subject, ParetoFront):
        code = pareto.outcome_of(subject)
        if not no_record:
            pareto.recorded(subject, found.actuator, found.command, found.date)
    else:
        code = ExitCode.MET if subject.met else ExitCode.MISSED
    if as_json:
        streams.out_json(found.to_dict() | ({"files": files} if files else {}))
    elif not quiet:
        _tell(found)
        say_files(files)
    if found.repeats is False and code == ExitCode.MET:
        code = ExitCode.MISSED
    sys.exit(code)


def _written(found: Rerun, out: Path) -> list[dict[str, Any]]:
    from .. import verbs
    from ..optimisation.pareto_result import ParetoFront

    how: dict[str, Any] = {"actuator": found.actuator, "command": found.command}
    how |= {"folder": out, "date": found.date}
    if isinstance(found.subject, ParetoFront):
        files = verbs.write_front(found.subject, **how) if found.subject.points else []
    else:
        files = verbs.report(found.subject, extra_tables=found.tables, **how)
    return [file.to_dict() for file in files]


def _tell(found: Rerun) -> None:
    """The tables of the command, then whether they are those of the report."""
    from ..optimisation.pareto_result import ParetoFront
    from ..optimisation.result import Optimisation
    from ..reporting.pareto_rows import front_text
    from ..reporting.terminal import evaluation_text, optimisation_text

    style = streams.style()
    if isinstance(found.subject, Optimisation):
        streams.out(optimisation_text(found.subject, **style), end="")
    elif isinstance(found.subject, ParetoFront):
        streams.out(front_text(found.subject, **style), end="")
    else:
        streams.out(evaluation_text(found.subject, **style), end="")
    streams.err(f"{found.command}\n{found.sentence}")
