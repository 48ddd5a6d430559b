"""Restore the result of a recorded run, and its report, without solving again."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Unpack

from ..base.errors import Diagnostic, InputError
from ..base.tables import Displayed
from ..version import VERSION
from .actuator import Actuator, Plugins, plugins_of, read_as
from .optimum import write_front, write_front_csv
from .recorded_runs import Run, differing, read_run, sha256, sound
from .reports import ReportArguments, report_design
from .sweeping import KeptSweep, kept_sweep, report_sweep

if TYPE_CHECKING:
    from ..evaluation import Evaluation
    from ..evaluation.plugin import Plugin
    from ..optimisation.pareto import ParetoFront
    from ..optimisation.result import Optimisation
    from ..pages import ReportFile


@dataclass(frozen=True, slots=True)
class Restored(Displayed):
    """A result from its record, with differences between the models then and now."""

    run: Run
    result: Optimisation | ParetoFront | KeptSweep
    actuator: Actuator
    doubts: tuple[str, ...] = ()

    @property
    def optimisation(self) -> Optimisation:
        """The result of `optimise`; raises `InputError` for another command's."""
        from ..optimisation.result import Optimisation

        if not isinstance(self.result, Optimisation):
            message = f"is a run of {self.run.head['kind']}, which has no single best design"
            raise InputError(Diagnostic(message, "name a run of optimise", str(self.run.path)))
        return self.result


def restore(of: Run | str | Path, *, plugins: Plugins = ()) -> Restored:
    """Restore the result of a recorded run without solving again.

    Designs are exactly those of the record; their evaluations come from the present models.
    `doubts` lists differences from the recorded values. For a sweep, the result is the location of
    its rows.

    Parameters
    ----------
    of : the run, or what `read_run` takes
    plugins : the Python files of its own metrics; as programs, they are never run unless named

    Raises
    ------
    InputError : a run of another command, a damaged record, or plugins that are not named
    """
    found = of if isinstance(of, Run) else read_run(of)
    kind = found.head.get("kind")
    if kind not in ("optimise", "pareto", "sweep"):
        message = f"is a run of {kind}, which has no such report"
        raise InputError(Diagnostic(message, "name a run that runs list shows", str(found.path)))
    try:
        with sound(found):
            given = found.body["input"]
            own = named_plugins(found, plugins)
            sets = [(path, value) for path, value in given["set"]]
            actuator = read_as(given["text"], given["name"], set=sets, plugins=own)
            if kind == "sweep":
                doubts = tuple(changed_plugins(found, own))
                return Restored(found, kept_sweep(found, actuator), actuator, doubts)
            result, shown = _solved(found, own)
            doubts = (*changed_plugins(found, own), *_doubts(found, shown))
            return Restored(found, result, actuator, doubts)
    except InputError as error:
        faults = [replace(x, file=x.file or str(found.path)) for x in error.diagnostics]
        raise InputError(faults) from None


def _solved(run: Run, own: tuple[Plugin, ...]) -> tuple[Optimisation | ParetoFront, Evaluation]:
    """An optimisation or a front, and its recorded evaluation."""
    from ..optimisation.pareto import ParetoFront
    from ..optimisation.recorded import from_plain
    from ..optimisation.result import Optimisation

    if run.head["kind"] == "pareto":
        front = from_plain(ParetoFront, run.body["state"], own)
        return front, front.evaluation
    best = from_plain(Optimisation, run.body["state"], own)
    return best, best.best_evaluation


def named_plugins(run: Run, plugins: Plugins) -> tuple[Plugin, ...]:
    """The plugins that this call names for a run; a record alone never runs a program.

    Raises
    ------
    InputError : the run had custom metrics, and none is named
    """
    own = plugins_of(plugins)
    files = [one["file"] or "a function of a script" for one in run.body["input"]["plugins"]]
    if files and not own:
        message = f"its custom metrics came from {', '.join(files)}, which is a program"
        raise InputError(Diagnostic(message, "name it with --plugin to run it", str(run.path)))
    return own


def changed_plugins(run: Run, own: Sequence[Plugin]) -> list[str]:
    """List files of custom metrics that differ from those recorded."""
    now = {sha256(file) for file in {plugin.file for plugin in own} if file}
    return [
        f"run {run.id} was made with another version of {one['file']} (its SHA-256 differs)"
        for one in run.body["input"]["plugins"]
        if one["file"] and one["sha256"] not in now
    ]


def _doubts(run: Run, now: Evaluation) -> list[str]:
    """Notes where the present models do not reproduce the record."""
    then = run.body["result"]["metrics"]
    before = {name: row["value"] for name, row in then.items()}
    changed = differing(before, {name: row.value for name, row in now.metrics.items()})
    version = str(run.head.get("version", ""))
    if not changed:
        return []
    names = ", ".join(changed[:3]) + (f" and {len(changed) - 3} more" if len(changed) > 3 else "")
    made = f"actuator-opt {version}" if version != VERSION else "other material data or plugins"
    return [
        f"run {run.id} was made by {made}; the present models (actuator-opt {VERSION}) give "
        f"other values of {names}, which the report shows"
    ]


def report_run(
    of: Restored | Run | str | Path, *, plugins: Plugins = (), **paper: Unpack[ReportArguments]
) -> list[ReportFile]:
    """Write the report of a recorded run, identical to that of its command.

    For a front these are its page, figure and CSV (``NAME_pareto.csv``), or nothing if no front was
    found. For a sweep see `report_sweep`.

    Parameters
    ----------
    of : argument or result of `restore`
    plugins : as `restore`
    paper : as `report`; design and command are those of the run, and its date unless one is given
    """
    found = of if isinstance(of, Restored) else restore(of, plugins=plugins)
    with sound(found.run):
        paper["actuator"], paper["command"] = found.actuator, found.run.head["command"]
        paper["date"] = paper.get("date") or found.run.body["date"]
        return _reported(found, paper)


def _reported(restored: Restored, paper: ReportArguments) -> list[ReportFile]:
    from ..optimisation.result import Optimisation
    from ..rendering.blocks import text_table

    result = restored.result
    if isinstance(result, KeptSweep):
        return report_sweep(result, **paper)
    if isinstance(result, Optimisation):
        tables = [
            text_table(
                table["title"],
                table["columns"],
                [[str(cell) for cell in row] for row in table["rows"]],
                table["note"],
                table["widths"],
            )
            for table in restored.run.body["tables"]
        ]
        return report_design(result, extra_tables=tables, **paper)
    files = write_front(result, **paper)
    return [*files, *(write_front_csv(result, x.path.with_suffix(".csv")) for x in files[:1])]


def draw_run(of: Run, folder: str | Path) -> list[Path]:
    """Draw the convergence of a run's search: ID-convergence.png and .svg.

    Raises
    ------
    InputError : a run of another command than optimise
    """
    from ..pages.trust import convergence_figure
    from ..rendering.paper import write_ink

    if of.head.get("kind") != "optimise":
        message = f"is a run of {of.head.get('kind')}, whose search has no convergence to draw"
        remedy = f"draw it with: actuator-opt report {of.id}"
        raise InputError(Diagnostic(message, remedy, str(of.path)))
    with sound(of):
        result = of.body["result"]
        title = f"{of.head['name']}: search, {result['algorithm']}, seed {of.head['seed']}"
        metric = str(of.head["objective"].get("metric", ""))
        ink = convergence_figure(of.body["trace"], metric, result["evaluations"], title)
        return write_ink(ink, Path(folder), f"{of.id}-convergence")
