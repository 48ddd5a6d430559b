"""Declares, once for every type of result, the functions that print, report and record it.

By the type of a result, the terminal and the library look up the functions for its text, JSON,
report, CSV, record and exit code. A function is named "module:function" below `actuator_opt` and
imported when it is used, or it is a method of the result. None means that the type does not have
this output. Every type must state report, CSV and record, as a function or as None; otherwise the
import fails.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any, Unpack

from ..base import runs as run_store
from ..base.arguments import guarded
from ..base.dataclass import dataclass
from ..base.errors import Diagnostic, ExitCode, UsageError
from ..design import Design
from ..evaluation import Evaluation
from ..evaluation.result import UNKNOWN
from .actuator import Actuator, Plugins, as_actuator
from .optimum import evaluate, with_yield
from .recorded_runs import Run
from .reports import require_format

if TYPE_CHECKING:
    from ..pages import ReportFile
    from ..rendering.console import Style

_PACKAGE = f"{__package__.rpartition('.')[0]}."


@dataclass(frozen=True)
class ResultKind:
    """The functions that output one type of result.

    Parameters
    ----------
    type : type of the result, as "module:class"
    exit_code : gives the exit code of a command with this result
    page : builds the `Page` of a result, which gives its text, report and HTML
    blocks : for a result without a page, builds the blocks of its text
    card : builds the blocks of a short text, which a command prints unless it is asked for all
    text : for a result without page and blocks, gives the terminal text of (result, colour=,
        unicode=, width=)
    report : writes the report of (result, **`ReportArguments`); some kinds need more keywords
    csv : writes the result to a path
    record : records the run of (result, actuator=, command=, date=)
    data : gives plain data for JSON, SI
    remarks : gives lines that are printed to standard error after the text
    writes : returns whether a report or CSV can be written for a result; None: always
    """

    type: str
    exit_code: Callable[[Any], ExitCode]
    report: str | None
    csv: str | None
    record: str | None
    page: str | None = None
    blocks: str | None = None
    card: str | None = None
    text: str | None = None
    data: str | None = "to_dict"
    remarks: Callable[[Any], list[str]] | None = None
    writes: Callable[[Any], bool] | None = None


def _always(result: object) -> ExitCode:
    """Exit code for results without requirements: always success."""
    return ExitCode.MET


def _missed(missed: bool) -> ExitCode:
    return ExitCode.MISSED if missed else ExitCode.MET


def _met(result: Any) -> ExitCode:
    return _missed(not result.met)


def _converged(study: Any) -> ExitCode:
    return ExitCode.MET if study.converged else ExitCode.SOLVER_FAILED


def _optimised(result: Any) -> ExitCode:
    if result.status == "undefined":
        return ExitCode.SOLVER_FAILED
    if result.status.startswith("interrupted"):
        return ExitCode.INTERRUPTED
    infeasible = result.status == "infeasible" or result.status.startswith("limit_inf")
    missed = not result.evaluation.met or (result.rounding is not None and not result.rounding.met)
    unlikely = result.robust is not None and not result.robust.reached
    return ExitCode.MISSED if infeasible or missed or unlikely else ExitCode.MET


def _solved(result: Any) -> ExitCode:
    if result.status == "unsolved":
        return ExitCode.SOLVER_FAILED
    return ExitCode.MET if result.points else ExitCode.MISSED


def _repeats(result: Any) -> ExitCode:
    code = exit_code(result.subject)
    return ExitCode.MISSED if result.repeats is False and code == ExitCode.MET else code


def _unrounded(result: Any) -> list[str]:
    from ..optimisation.rounding import unrounded

    return [*filter(None, [unrounded(result)])]


def kinds(*declared: ResultKind) -> dict[str, ResultKind]:
    """Index the declared kinds by their type; reject a type that is declared twice."""
    by_type = {kind.type: kind for kind in declared}
    if len(by_type) != len(declared):
        raise TypeError("a type of result is declared twice")
    return by_type


# fmt: off
KINDS = kinds(
    ResultKind(
        "evaluation.result:Evaluation", _met, page="pages.report:page", card="pages.card:blocks",
        report="api.reports:report_design", csv="api:write_duty", record=None,
    ),
    ResultKind(
        "optimisation.result:Optimisation", _optimised, page="pages.report:page",
        card="pages.card:blocks", report="api.reports:report_design", csv=None, record="api:record",
        remarks=_unrounded, writes=lambda result: not result.status.startswith("interrupted"),
    ),
    ResultKind(
        "api.optimum:Prices", lambda prices: _optimised(prices.optimisation), page="page",
        report="report", csv=None, record=None,
    ),
    ResultKind(
        "optimisation.pareto:ParetoFront", _solved, page="pages.pareto:page",
        report="api:write_front", csv="api:write_front_csv",
        record="api:record_front", writes=lambda front: bool(front.points),
    ),
    ResultKind(
        "uncertainties.result:Uncertainty", _met, page="pages.uncertainty:page",
        report="api:write_uncertainty", csv="api:write_draws", record=None,
    ),
    ResultKind(
        "evaluation.comparison:Comparison", _always, page="pages.comparison:page",
        report="api.comparing:report_comparison", csv=None, record=None,
        data="api:comparison_json",
    ),
    ResultKind(
        "sweeps.result:Swept", lambda swept: _missed(not swept.best),
        page="pages.sweep:page",
        report=None, csv=None, record="api:record_sweep",
        writes=lambda swept: False,  # rows are written during the sweep, figures by draw_sweep
    ),
    ResultKind(
        "studies.seal:SealStudy", _converged, page="pages.seal:page",
        report="api:write_seal", csv=None, record=None,
    ),
    ResultKind(
        "simulation.result:Simulation", _met, page="pages.simulation:page",
        report="api:write_simulation", csv="api:write_signals", record=None,
    ),
    ResultKind(
        "simulation.basis:Basis", _always, blocks="pages.simulation_basis:blocks",
        report=None, csv=None, record=None,
    ),
    ResultKind(
        "api.simulations:Compared", lambda compared: _met(compared.simulation), blocks="blocks",
        report="report", csv=None, record=None,
    ),
    ResultKind(
        "simulation.sensitivity:Sensitivities", _always,
        blocks="pages.verification:sensitivity_blocks", report=None, csv=None, record=None,
    ),
    ResultKind(
        "simulation.verification.verify:Verification", _met,
        blocks="pages.verification:blocks", report=None, csv=None, record=None,
    ),
    ResultKind(
        "identification.result:Identification", _always,
        page="pages.identification:page",
        report="api:write_identification", csv="api:write_series", record=None,
    ),
    ResultKind(
        "identification.bending:BendingResult", _always, page="pages.bending:page",
        report=None, csv=None, record=None,
    ),
    ResultKind(
        "api.records:Calibrated", lambda calibrated: _met(calibrated.redesign.evaluation),
        page="page", report="api:write_calibration", csv=None, record=None,
    ),
    ResultKind(
        "api.installation:Installation", lambda installation: _missed(not installation.ok),
        text="text", report=None, csv=None, record=None,
    ),
    ResultKind(
        "api.explaining:Explanation", _always, text="text", report=None, csv=None, record=None,
    ),
    ResultKind(
        "api.reference:Catalogue", _always, text="text", report=None, csv=None, record=None,
    ),
    ResultKind(
        "api.recorded_runs:Run", _always, text="text",
        report="api:report_run", csv=None, record=None,
    ),
    ResultKind(
        "api.sweeping:KeptSweep", lambda kept: _missed(not kept.run.head["met"]),
        report="api.sweeping:report_sweep", csv=None, record=None, data=None,
    ),
    ResultKind(
        "api.restoring:Restored", lambda restored: exit_code(restored.result),
        report="api:report_run", csv=None, record=None, data=None,
    ),
    ResultKind(
        "api.repeating:Rerun", _repeats, text="text", report="report", csv=None, record="record",
        remarks=lambda rerun: [rerun.command, rerun.sentence],
    ),
)
# fmt: on


def kind_of(result: object) -> ResultKind:
    """The kind of a result, by its type; raises `UsageError` for other objects."""
    for cls in type(result).__mro__:
        kind = KINDS.get(f"{cls.__module__.removeprefix(_PACKAGE)}:{cls.__qualname__}")
        if kind is not None:
            return kind
    message = f"{type(result).__name__} is not a result"
    raise UsageError(Diagnostic(message, "give one of evaluate, optimise, sweep, simulate, ..."))


def piece(name: str, result: object) -> Callable[..., Any]:
    """Import a function by its name (see `ResultKind`), with the result as its first argument."""
    module, _, function = name.rpartition(":")
    if not module:
        return getattr(result, name)  # type: ignore[no-any-return]
    return partial(getattr(import_module(_PACKAGE + module), function), result)


def exit_code(result: object) -> ExitCode:
    """The exit code of a command that ends with this result."""
    return kind_of(result).exit_code(result)


def text(result: object, **style: Unpack[Style]) -> str:
    """The terminal text of a result; "" if its kind has none."""
    kind = kind_of(result)
    if kind.page is not None:
        from ..rendering import terminal

        return terminal.text(piece(kind.page, result)(), **style)
    if kind.blocks is not None:
        from ..rendering import terminal

        return terminal.blocks_text(piece(kind.blocks, result)(), **style)
    return "" if kind.text is None else str(piece(kind.text, result)(**style))


def card(result: object, options: Mapping[str, Any], **style: Unpack[Style]) -> str:
    """The short text of a result, or its whole text if its kind has no short one.

    `options` are those of the card, such as `again` and `written` of `pages.card.blocks`.
    """
    name = kind_of(result).card
    if name is None:
        return text(result, **style)
    from ..rendering import terminal

    return terminal.blocks_text(piece(name, result)(**options), **style)


def html(result: object) -> str:
    """The main parts of a result as HTML for notebooks; "" for a result without text."""
    from ..rendering import html as markup

    kind = kind_of(result)
    if kind.page is not None:
        return markup.summary(piece(kind.page, result)())
    if kind.blocks is not None:
        return markup.pieces(piece(kind.blocks, result)())
    words = text(result, colour=False, unicode=True, width=100)
    return markup.listing(words) if words else ""


def data(result: object) -> dict[str, Any]:
    """A result as plain data for JSON, SI."""
    name = kind_of(result).data
    return {} if name is None else dict(piece(name, result)())


def remarks(result: object) -> list[str]:
    """Lines that are printed to standard error after the text of a result."""
    lines_of = kind_of(result).remarks
    return [] if lines_of is None else lines_of(result)


def writes(result: object) -> bool:
    """Whether a report or CSV can be written for this result."""
    condition = kind_of(result).writes
    return condition is None or condition(result)


def write_csv(result: object, path: str | Path) -> ReportFile:
    """Write a result as CSV; raises `UsageError` if its kind has none."""
    name = kind_of(result).csv
    if name is None:
        raise UsageError(Diagnostic(f"{type(result).__name__} has no CSV", "leave out --csv"))
    file: ReportFile = piece(name, result)(path)
    return file


def keep(result: object, **context: Any) -> Run | None:
    """Record the run of a result, if such results are recorded. Parameters as for `record`."""
    name = kind_of(result).record
    return None if name is None else piece(name, result)(**context)


@guarded
def report(
    subject: object,
    *,
    folder: str | Path = "reports",
    stem: str | None = None,
    actuator: Actuator | None = None,
    command: str = "",
    date: str | None = None,
    all_pages: bool = False,
    format: str = "pdf",
    seed: int = 0,
    plugins: Plugins = (),
    **more: Any,
) -> list[ReportFile]:
    """Write the report of a design or a result, identical to that of the terminal command.

    A design is evaluated first, as by ``actuator-opt report``. If an evaluation has no yield
    estimate, it gets one (`with_yield`).

    Parameters
    ----------
    subject : a design in any form, a run (id, ``last``, `Run`, `Restored`), or a result: of
        `evaluate`, `optimise`, `pareto`, `uncertainty`, `seal`, `simulate`, `compare_measured`,
        `identify`, `calibrate`, `compare`, `rerun`
    folder, stem : folder and name of the files; default: the design's name in ``reports/``
    actuator : the design as read, which the report lists and attaches
    command : command that made the report; it is printed on the report
    date : ISO date; default: that of SOURCE_DATE_EPOCH, or else none
    all_pages : whether to write an image of every sheet, not only of the first
    format : "pdf" (with PNG), "html" (a file that needs no network), or "both"
    seed : seed of the samples for the yield estimate
    plugins : the user's metrics and constraints, for a design that is not an `Actuator` yet, or a
        run
    more : for an evaluation or an optimisation, `dynamics_verified` (from `verify_dynamics`),
        `extra_tables`, and `attached`, further files of the PDF; for a simulation, `scenario` as
        read, `measured` and `sensitivities`; for a seal, `sheet` (False: only the map)

    Returns
    -------
    the files, each with its path and SHA-256; no file for a front without designs

    Raises
    ------
    UsageError : the date is not an ISO date, the result has no report, or `actuator` or `scenario`
        is missing
    InputError : the folder cannot be written; partial files are removed
    """
    paper: dict[str, Any] = {"folder": folder, "stem": stem, "command": command, "date": date}
    require_format(format)
    paper |= {"all_pages": True} if all_pages else {}
    paper |= {"format": format} if format != "pdf" else {}
    if isinstance(subject, Run) or (
        isinstance(subject, str | Path) and run_store.is_name(str(subject))
    ):
        from .restoring import restore

        subject = restore(subject, plugins=plugins)
    elif isinstance(subject, Actuator | Design | str | Path):
        actuator = as_actuator(subject, plugins)
        subject = evaluate(actuator, seed=seed)
    elif isinstance(subject, Evaluation) and subject.yield_estimate == UNKNOWN:
        loaded_plugins = () if actuator is None else actuator.plugins
        subject = with_yield(subject, plugins=loaded_plugins, seed=seed)
    name = kind_of(subject).report
    if name is None:
        message = f"{type(subject).__name__} has no report"
        raise UsageError(Diagnostic(message, "print it, or report the design"))
    files: list[ReportFile] = piece(name, subject)(actuator=actuator, **paper, **more)
    return files
