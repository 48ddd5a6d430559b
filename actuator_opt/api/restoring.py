"""Restores the result of a recorded run, and its report, without solving again."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Unpack

from ..base.arguments import guarded
from ..base.dataclass import dataclass
from ..base.errors import Diagnostic, InputError
from ..base.tables import Displayed
from ..version import VERSION
from .actuator import Actuator, Plugins, plugins_of, read_as
from .optimum import write_front, write_front_csv
from .recorded_runs import Run, damage_reported, differing, read_run, sha256
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
    """A result restored from its record, and values that the present models compute differently."""

    run: Run
    result: Optimisation | ParetoFront | KeptSweep
    actuator: Actuator
    doubts: tuple[str, ...] = ()

    @property
    def in_short(self) -> tuple[str, str]:
        """The run, and the number of values that the present models compute differently."""
        count = len(self.doubts)
        changed = f", {count} value{'' if count == 1 else 's'} changed" if count else ""
        return self.actuator.design.name, f"run {self.run.id} of {self.run.head['kind']}{changed}"

    @property
    def optimisation(self) -> Optimisation:
        """The result, if the command was `optimise`; raises `InputError` for other commands."""
        from ..optimisation.result import Optimisation

        if not isinstance(self.result, Optimisation):
            message = f"is a run of {self.run.head['kind']}, which has no single best design"
            raise InputError(Diagnostic(message, "name a run of optimise", str(self.run.path)))
        return self.result


@guarded
def restore(of: Run | str | Path, *, plugins: Plugins = ()) -> Restored:
    """Restore the result of a recorded run without solving again.

    Designs are exactly those of the record, but they are evaluated with the present models.
    `doubts` lists where the values differ from the record. For a sweep, the result says where its
    rows are stored.

    Parameters
    ----------
    of : the run, or its name as for `read_run`
    plugins : the Python files with the run's custom metrics; they only run if given here

    Raises
    ------
    InputError : the run is not of `optimise`, `pareto` or `sweep`; its record is damaged; or its
        plugins are not given
    """
    run = of if isinstance(of, Run) else read_run(of)
    kind = run.head.get("kind")
    if kind not in ("optimise", "pareto", "sweep"):
        message = f"is a run of {kind}; only optimise, pareto and sweep can be restored"
        raise InputError(Diagnostic(message, "name a run that `runs list` shows", str(run.path)))
    try:
        with damage_reported(run):
            source = run.body["input"]
            loaded_plugins = named_plugins(run, plugins)
            sets = [
                *((path, None) for path in source.get("unset", ())),
                *((path, value) for path, value in source["set"]),
            ]
            actuator = read_as(
                source["text"],
                source["name"],
                set=sets,
                plugins=loaded_plugins,
                files=source.get("files"),
            )
            if kind == "sweep":
                doubts = tuple(changed_plugins(run, loaded_plugins))
                return Restored(run, kept_sweep(run, actuator), actuator, doubts)
            result, evaluation = _solved(run, loaded_plugins)
            doubts = (*changed_plugins(run, loaded_plugins), *_doubts(run, evaluation))
            return Restored(run, result, actuator, doubts)
    except InputError as error:
        faults = [replace(x, file=x.file or str(run.path)) for x in error.diagnostics]
        raise InputError(faults) from None


def _solved(run: Run, plugins: tuple[Plugin, ...]) -> tuple[Optimisation | ParetoFront, Evaluation]:
    """The recorded optimisation or Pareto front, and the evaluation to compare with the record."""
    from ..optimisation.pareto import ParetoFront
    from ..optimisation.result import Optimisation
    from ..optimisation.stored_results import from_plain

    if run.head["kind"] == "pareto":
        front = from_plain(ParetoFront, run.body["state"], plugins)
        return front, front.evaluation
    best = from_plain(Optimisation, run.body["state"], plugins)
    return best, best.best_evaluation


def named_plugins(run: Run, plugins: Plugins) -> tuple[Plugin, ...]:
    """The plugins that the caller names for a run; a record alone never runs a program.

    Raises
    ------
    InputError : the run had custom metrics, but the caller names no plugin
    """
    loaded_plugins = plugins_of(plugins)
    files = [plugin["file"] or "a function of a script" for plugin in run.body["input"]["plugins"]]
    if files and not loaded_plugins:
        message = (
            f"its custom metrics came from {', '.join(files)}; a plug-in is a program and only "
            "runs if you name it"
        )
        raise InputError(Diagnostic(message, "name it with --plugin to run it", str(run.path)))
    return loaded_plugins


def changed_plugins(run: Run, loaded_plugins: Sequence[Plugin]) -> list[str]:
    """List the plugin files that differ from those recorded."""
    hashes = {sha256(file) for file in {plugin.file for plugin in loaded_plugins} if file}
    return [
        f"run {run.id} was made with another version of {plugin['file']} (its SHA-256 differs)"
        for plugin in run.body["input"]["plugins"]
        if plugin["file"] and plugin["sha256"] not in hashes
    ]


def _doubts(run: Run, evaluation: Evaluation) -> list[str]:
    """Notes on values of the record that the present models do not reproduce."""
    recorded = {name: row["value"] for name, row in run.body["result"]["metrics"].items()}
    present = {name: row.value for name, row in evaluation.metrics.items()}
    changed = differing(recorded, present)
    if not changed:
        return []
    version = str(run.head.get("version", ""))
    names = ", ".join(changed[:3]) + (f" and {len(changed) - 3} more" if len(changed) > 3 else "")
    origin = f"actuator-opt {version}" if version != VERSION else "other material data or plugins"
    return [
        f"run {run.id} was made by {origin}; the models of this installation (actuator-opt "
        f"{VERSION}) give other values of {names}, which the report shows"
    ]


@guarded
def report_run(
    of: Restored | Run | str | Path, *, plugins: Plugins = (), **paper: Unpack[ReportArguments]
) -> list[ReportFile]:
    """Write the report of a recorded run, identical to that of its command.

    For a Pareto front, this writes its page, figure and CSV file (``NAME_pareto.csv``), or nothing
    if the front has no designs. For a sweep see `report_sweep`.

    Parameters
    ----------
    of : a run as for `restore`, or the result of `restore`
    plugins : as for `restore`
    paper : as for `report`. Design and command are those of the run; so is the date, if none is
        given
    """
    restored = of if isinstance(of, Restored) else restore(of, plugins=plugins)
    with damage_reported(restored.run):
        paper["actuator"], paper["command"] = restored.actuator, restored.run.head["command"]
        paper["date"] = paper.get("date") or restored.run.body["date"]
        return _reported(restored, paper)


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


@guarded
def draw_run(of: Run, folder: str | Path) -> list[Path]:
    """Draw how a run's search converged, in the files ID-convergence.png and .svg.

    Raises
    ------
    InputError : the run is not a run of `optimise`
    """
    from ..pages.trust import convergence_figure
    from ..rendering.paper import write_ink

    if of.head.get("kind") != "optimise":
        message = f"is a run of {of.head.get('kind')}, whose search has no convergence to draw"
        remedy = f"draw it with: actuator-opt report {of.id}"
        raise InputError(Diagnostic(message, remedy, str(of.path)))
    with damage_reported(of):
        result = of.body["result"]
        title = f"{of.head['name']}: search, {result['algorithm']}, seed {of.head['seed']}"
        metric = str(of.head["objective"].get("metric", ""))
        ink = convergence_figure(of.body["trace"], metric, result["evaluations"], title)
        return write_ink(ink, Path(folder), f"{of.id}-convergence")
