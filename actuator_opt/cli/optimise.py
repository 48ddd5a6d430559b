"""`optimise` and `sensitivity`: the best design, and what its limits cost."""

from __future__ import annotations

import sys
from dataclasses import replace
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ..errors import Diagnostic, ExitCode
from . import streams
from .options import (
    REPORTS,
    Algorithm,
    Certify,
    Date,
    DesignFile,
    Json,
    NoRecord,
    Out,
    PluginFile,
    Quiet,
    Report,
    Seed,
    Set,
    StandardSizes,
    Starts,
    VerifyDynamics,
    WholePlies,
    Write,
    Yield,
)
from .shared import (
    check_targets,
    command_line,
    keep_record,
    read_actuator,
    say_files,
    write_report,
)

if TYPE_CHECKING:
    from pathlib import Path

    from ..optimisation.result import Optimisation
    from ..reporting import ExtraTable
    from ..simulation.verification import Verification
    from ..verbs import Actuator, Trial


def optimise(
    design: DesignFile,
    sets: Set = None,
    algorithm: Algorithm = "auto",
    starts: Starts = 6,
    whole_plies: WholePlies = False,
    standard_sizes: StandardSizes = False,
    certify: Certify = False,
    target: Yield = None,
    verify: VerifyDynamics = None,
    write: Write = None,
    out: Out = REPORTS,
    report: Annotated[
        bool, typer.Option("--report", help="Write the report although --json is given.")
    ] = False,
    date: Date = None,
    seed: Seed = 0,
    plugin: PluginFile = None,
    no_record: NoRecord = False,
    as_json: Json = False,
    quiet: Quiet = False,
) -> None:
    """Find the best design, price its limits, write the report."""
    from .. import verbs

    reporting = report or not as_json
    check_targets(out if reporting else None, date, write)
    actuator = read_actuator(design, sets, plugin)
    trial = _scenario(verify, actuator)
    with streams.watching():
        result = verbs.optimise(
            actuator,
            algorithm=algorithm,
            starts=starts,
            seed=seed,
            whole_plies=whole_plies,
            keep_interrupted=True,
            standard_sizes=standard_sizes,
            certify=certify,
            yield_target=target,
        )
    outcome = outcome_of(result)
    stopped = outcome == ExitCode.INTERRUPTED
    saved, unsaved = _saved(result, outcome, write, actuator)
    timed = None if trial is None or stopped else _timed(trial, result)
    tables = _dynamics_tables(timed)
    files = write_report(result, actuator, out, date, tables) if reporting and not stopped else []
    if as_json:
        streams.out_json(_as_json(result, timed, files, unsaved))
    elif not quiet:
        _tell(result, timed)
        say_files(saved + files)
    if unsaved is not None and not as_json:
        streams.err(str(unsaved))
    if not no_record:
        recorded(result, actuator, command_line(), date, tables)
    if outcome == ExitCode.MET and timed is not None and not timed.met:
        outcome = ExitCode.MISSED
    sys.exit(outcome)  # an Exit with the status of an interrupt would be told as one


def recorded(
    result: Optimisation,
    actuator: Actuator,
    command: str,
    date: str | None,
    tables: list[ExtraTable],
) -> None:
    """Keep a record of the run; where that fails, one line says so."""
    from ..verbs import record

    how: dict[str, Any] = {"command": command, "date": date, "extra_tables": tables}
    keep_record(lambda: record(result, actuator=actuator, **how))


def _scenario(file: str | None, actuator: Actuator) -> Trial | None:
    """The scenario to verify the best design in, which must be one for it."""
    from .. import verbs

    if file is None:
        return None
    trial = verbs.read_scenario(file)
    verbs.fitting(trial, actuator)
    return trial


def _saved(
    result: Optimisation, outcome: ExitCode, write: Path | None, actuator: Actuator
) -> tuple[list[dict[str, Any]], Diagnostic | None]:
    """Save the best design where one is asked for: its file, or why there is none to save."""
    from .. import verbs

    if write is None:
        return [], None
    if outcome == ExitCode.MET or result.status == "interrupted":
        verbs.save(result, write, source=actuator.source)
        return [{"path": write}], None
    told = result if result.robust is not None else result.rounding or result
    why = "; ".join(part for part in (told.sentence, told.remedy) if part)
    message = f"not written, there is no design to save: {why}"
    return [], Diagnostic(message, file=str(write))


def _timed(trial: Trial, result: Optimisation) -> Verification:
    """What the time domain says of the best design in its scenario."""
    from .. import verbs

    with streams.watching():
        return verbs.verify_dynamics(trial, result.best)


def _as_json(
    result: Optimisation,
    timed: Verification | None,
    files: list[dict[str, Any]],
    unsaved: Diagnostic | None,
) -> dict[str, Any]:
    """The object of the contract, what the time domain says, files of the report, faults."""
    more: dict[str, Any] = {} if timed is None else {"dynamics_verified": timed.to_dict()}
    if files:
        more["files"] = files
    if unsaved is not None:
        more["errors"] = [unsaved.to_dict()]
    return result.to_dict() | more


def _tell(result: Optimisation, timed: Verification | None) -> None:
    """Print the tables, and a remark where plies are not whole yet."""
    from ..optimisation.rounding import unrounded
    from ..reporting.terminal import optimisation_text

    streams.out(optimisation_text(result, **streams.style()), end="")
    if timed is not None:
        from ..reporting.verification_text import verification_text

        streams.out("\n" + verification_text(timed, **streams.style()), end="")
    if remark := unrounded(result):
        streams.err(remark)


def _dynamics_tables(timed: Verification | None) -> list[ExtraTable]:
    """The same as tables for its report."""
    if timed is None:
        return []
    from ..reporting.verification_rows import verification_rows

    return [*verification_rows(timed)]


def outcome_of(result: Optimisation) -> ExitCode:
    """The exit status of an optimisation."""
    if result.status == "undefined":
        return ExitCode.SOLVER_FAILED
    if result.status.startswith("interrupted"):
        return ExitCode.INTERRUPTED
    infeasible = result.status == "infeasible" or result.status.startswith("limit_inf")
    missed = not result.evaluation.met or (result.rounding is not None and not result.rounding.met)
    unlikely = result.robust is not None and not result.robust.reached
    return ExitCode.MISSED if infeasible or missed or unlikely else ExitCode.MET


def sensitivity(
    design: DesignFile,
    sets: Set = None,
    plugin: PluginFile = None,
    report: Report = False,
    out: Out = REPORTS,
    date: Date = None,
    seed: Seed = 0,
    as_json: Json = False,
    quiet: Quiet = False,
) -> None:
    """What each requirement and parameter costs at the optimum."""
    from .. import verbs

    if report:
        check_targets(out, date)
    actuator = read_actuator(design, sets, plugin)
    with streams.watching():
        result = verbs.optimise(actuator, seed=seed)
    files = write_report(result, actuator, out, date) if report else []
    if as_json:
        data = replace(result, rounding=None).to_dict()  # prices are of the continuous optimum
        keys = ["name", "version", "status", "outcome", "objective", "sensitivities"]
        keys += ["what_buys_most", "kkt", "infeasibility"]
        kept = {key: data[key] for key in keys if key in data}
        streams.out_json(kept | ({"files": files} if files else {}))
    elif not quiet:
        from ..reporting import infeasibility_card, prices

        style = streams.style()
        shown = prices.terminal(result, moving=True, **style)
        streams.out(shown or infeasibility_card.terminal(result, **style) or result.sentence)
        say_files(files)
    raise typer.Exit(outcome_of(result))
