"""Run records: what was asked, what came out, and the report of it without solving again."""

from __future__ import annotations

import hashlib
import os
import platform
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from datetime import UTC, datetime
from importlib import metadata
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from .. import run_store
from ..errors import Diagnostic, InputError
from ..evaluation.plugin import Plugin
from ..version import VERSION
from .actuator import Actuator, Plugins, plugins_of, read_as
from .reports import date_from_environment, file_name, report

if TYPE_CHECKING:
    from ..evaluation import Evaluation
    from ..optimisation.result import Optimisation
    from ..reporting import ExtraTable, ReportFile

CLOSE = 1e-9
"""Relative difference up to which a number counts as repeated: a choice, far above rounding."""


@dataclass(frozen=True, slots=True)
class Run:
    """A recorded run: `head` says what lists show, `body` holds input, versions and result."""

    id: str
    path: Path
    head: Mapping[str, Any]
    body: Mapping[str, Any]

    def to_dict(self) -> dict[str, Any]:
        """The `runs show --json` object."""
        kept = {key: value for key, value in self.body.items() if key not in ("state", "tables")}
        return {"id": self.id, "path": str(self.path)} | dict(self.head) | kept


@dataclass(frozen=True, slots=True)
class Restored:
    """An optimisation out of its record, and where today's models say otherwise than then."""

    run: Run
    optimisation: Optimisation
    actuator: Actuator
    doubts: tuple[str, ...]


def record(
    result: Optimisation,
    *,
    actuator: Actuator,
    command: str = "",
    date: str | None = None,
    extra_tables: Sequence[ExtraTable] = (),
    folder: str | Path | None = None,
) -> Run | None:
    """Record an optimisation with its input, so that it can be shown and reported later.

    Parameters
    ----------
    result : of `optimise`
    actuator : that was optimised
    command, date, extra_tables : of its report
    folder : where to; default: ACTUATOR_OPT_RUNS, else the person's data folder

    Returns
    -------
    the record; None where recording is switched off (ACTUATOR_OPT_NO_RECORD)

    Raises
    ------
    InputError : it cannot be written
    """
    from ..optimisation.recorded import to_plain

    head = {
        "status": result.status,
        "outcome": result.sentence,
        "met": result.best_evaluation.met and (result.rounding is None or result.rounding.met),
        "objective": result.to_dict()["objective"],
        "seconds": result.seconds,
    }
    more = {
        "variables": {v.path: v.value for v in result.best_variables},
        "trace": [list(row) for row in result.trace],
        "result": result.to_dict(),
        "state": to_plain(result),
        "tables": [asdict(table) for table in extra_tables],
    }
    return record_run(
        "optimise", head, more, actuator=actuator, command=command, date=date,
        seed=result.seed, folder=folder,
    )  # fmt: skip


def record_run(
    kind: Literal["optimise", "pareto", "sweep"],
    head: Mapping[str, Any],
    body: Mapping[str, Any],
    *,
    actuator: Actuator,
    command: str = "",
    date: str | None = None,
    seed: int = 0,
    folder: str | Path | None = None,
) -> Run | None:
    """Record a run of any command; parameters as `record`.

    Parameters
    ----------
    kind : the command
    head : its outcome in a few plain numbers and words, which lists show
    body : everything else, as plain data
    """
    from ..design.writer import to_yaml
    from ..evaluation.build import spec_hash

    place = run_store.folder() if folder is None else Path(folder)
    if place is None:
        return None
    source = actuator.source
    started = _started()
    first = {
        "kind": kind,
        "name": actuator.design.name,
        "file": file_name(actuator.design, source),
        "started": started.isoformat(timespec="seconds").replace("+00:00", "Z"),
        "command": command,
        "version": VERSION,
        "spec_hash": spec_hash(actuator.subject()),
        "seed": seed,
    }
    rest = {
        "date": date or date_from_environment(),
        "input": {
            "name": file_name(actuator.design, source),
            "text": to_yaml(actuator.design) if source is None else source.text,
            "set": [] if source is None else [[x.path, x.value] for x in source.overrides.values()],
            "plugins": [_plugin(file) for file in _files(actuator.plugins)],
        },
        "versions": _versions(),
    }
    head, body = first | dict(head), rest | dict(body)
    path = run_store.write(place, f"{started:%Y%m%d-%H%M%S}", head, body)
    return Run(path.stem, path, head, body)


def _started() -> datetime:
    """Now, or the time of SOURCE_DATE_EPOCH; whole seconds of UTC."""
    if date_from_environment() is not None:
        return datetime.fromtimestamp(int(os.environ["SOURCE_DATE_EPOCH"]), UTC)
    return datetime.now(UTC).replace(microsecond=0)


def _files(plugins: Sequence[Plugin]) -> list[str]:
    """The Python files of plugins, each once; "" stands for functions of a script."""
    return list(dict.fromkeys(plugin.file for plugin in plugins))


def _plugin(file: str) -> dict[str, str]:
    return {"file": file, "sha256": _sha256(file)}


def _sha256(file: str) -> str:
    try:
        return hashlib.sha256(Path(file).read_bytes()).hexdigest()
    except OSError:
        return ""


def _versions() -> dict[str, str]:
    found = {"actuator-opt": VERSION, "python": platform.python_version()}
    for name in ("numpy", "scipy", "nlopt", "cvxpy", "matplotlib", "typst"):
        try:
            found[name] = metadata.version(name)
        except metadata.PackageNotFoundError:
            continue
    return found


def runs(
    *,
    design: str | None = None,
    command: str | None = None,
    folder: str | Path | None = None,
) -> tuple[list[run_store.Entry], list[Diagnostic]]:
    """Recorded runs, newest first, and what is wrong with records that cannot be read.

    Parameters
    ----------
    design : only those of a design of this name or file
    command : only those of this command (``optimise``)
    folder : where they are; default as `record`
    """
    place = run_store.folder() if folder is None else Path(folder)
    if place is None:
        return [], []
    found, faults = run_store.entries(place)
    stem = None if design is None else Path(design).name
    kept = [
        entry
        for entry in found
        if (command is None or entry.head.get("kind") == _spelt(command))
        and (stem is None or stem in _names(entry.head))
    ]
    return kept, faults


def _spelt(command: str) -> str:
    return "optimise" if command == "optimize" else command


def _names(head: Mapping[str, Any]) -> tuple[str, ...]:
    file = str(head.get("file", ""))
    return (str(head.get("name", "")), file, Path(file).stem)


def read_run(name: str | Path, *, folder: str | Path | None = None) -> Run:
    """A recorded run by its id, the beginning of one, ``last``, or its file.

    Raises
    ------
    InputError : none, several, a damaged or a newer one
    """
    place = run_store.folder() if folder is None else Path(folder)
    path = run_store.find(place, str(name))
    head, body = run_store.read(path)
    return Run(path.stem, path, head, body)


def delete_run(name: str, *, folder: str | Path | None = None) -> str:
    """Delete a recorded run; its id. Parameters as `read_run`."""
    path = run_store.find(run_store.folder() if folder is None else Path(folder), name)
    if not run_store.is_record(path):
        remedy = "write its id"
        raise InputError(Diagnostic("is no record of a run", remedy, str(path)))
    run_store.delete(path)
    return path.stem


def prune_runs(*, keep: int, folder: str | Path | None = None) -> list[str]:
    """Delete all runs but the newest `keep`; ids of those deleted."""
    place = run_store.folder() if folder is None else Path(folder)
    if place is None:
        return []
    found, _ = run_store.entries(place)
    for entry in found[keep:]:
        run_store.delete(entry.path)
    return [entry.id for entry in found[keep:]]


def restore(of: Run | str | Path, *, plugins: Plugins = ()) -> Restored:
    """The optimisation of a recorded run, nothing solved again.

    Designs are those of the record to the last digit; their evaluations come from the models as
    they are now. `doubts` says where these differ from what was recorded.

    Parameters
    ----------
    of : the run, or what `read_run` takes
    plugins : its own metrics; default: the files it was made with

    Raises
    ------
    InputError : a run of another command, a damaged record, plugins that are missing or changed
    """
    from ..optimisation.recorded import from_plain

    found = of if isinstance(of, Run) else read_run(of)
    kind = found.head.get("kind")
    if kind != "optimise":
        message = f"is a run of {kind}, which has no such report"
        raise InputError(Diagnostic(message, "name a run of optimise", str(found.path)))
    try:
        given = found.body["input"]
        own = plugins_of(plugins) or plugins_of(_unchanged(given["plugins"], found.path))
        sets = [(path, value) for path, value in given["set"]]
        actuator = read_as(given["text"], given["name"], set=sets, plugins=own)
        result = from_plain(found.body["state"], own)
    except (KeyError, TypeError, ValueError) as error:
        message = f"is damaged ({type(error).__name__})"
        raise InputError(Diagnostic(message, "run it again", str(found.path))) from None
    except InputError as error:
        faults = [replace(x, file=x.file or str(found.path)) for x in error.diagnostics]
        raise InputError(faults) from None
    return Restored(found, result, actuator, tuple(_doubts(found, result.best_evaluation)))


def _unchanged(files: Sequence[Mapping[str, str]], path: Path) -> list[str]:
    """Plugin files of a record, which must be what they were: they are run."""
    for one in files:
        now = _sha256(one["file"]) if one["file"] else ""
        if now and now == one["sha256"]:
            continue
        name = one["file"] or "a function of a script"
        why = "has changed since" if now else "is not there"
        message = f"its own metrics came from {name}, which {why}"
        raise InputError(Diagnostic(message, "name the file with --plugin", str(path)))
    return [one["file"] for one in files]


def _doubts(found: Run, now: Evaluation) -> list[str]:
    """What to know where today's models do not repeat what was recorded."""
    then = found.body["result"]["metrics"]
    before = {name: row["value"] for name, row in then.items()}
    changed = differing(before, {name: row.value for name, row in now.metrics.items()})
    version = str(found.head.get("version", ""))
    if not changed:
        return []
    names = ", ".join(changed[:3]) + (f" and {len(changed) - 3} more" if len(changed) > 3 else "")
    made = f"actuator-opt {version}" if version != VERSION else "other material data or plugins"
    return [
        f"run {found.id} was made by {made}; today's models (actuator-opt {VERSION}) give other "
        f"values of {names}, which the report shows"
    ]


def differing(then: Mapping[str, Any], now: Mapping[str, Any]) -> list[str]:
    """Names whose numbers are not the same within `CLOSE`, and those only one side has."""
    names = dict.fromkeys([*then, *now])
    return [name for name in names if not same(then.get(name), now.get(name))]


def same(a: Any, b: Any) -> bool:
    """Whether two values are equal, numbers within `CLOSE`."""
    if isinstance(a, (int, float)) and isinstance(b, (int, float)):
        return abs(a - b) <= CLOSE * max(abs(a), abs(b))
    return bool(a == b)


def report_run(
    of: Restored | Run | str | Path,
    *,
    folder: str | Path = "reports",
    date: str | None = None,
    plugins: Plugins = (),
) -> list[ReportFile]:
    """Write the report of a recorded run: the bytes of the report that its command wrote.

    Parameters
    ----------
    of : what `restore` takes, or gives
    folder : where to
    date : default: that of the run
    plugins : as `restore`
    """
    from ..reporting import ExtraTable

    found = of if isinstance(of, Restored) else restore(of, plugins=plugins)
    body = found.run.body
    return report(
        found.optimisation,
        folder=folder,
        actuator=found.actuator,
        command=found.run.head["command"],
        date=date or body["date"],
        extra_tables=[ExtraTable(**table) for table in body["tables"]],
    )


def draw_run(of: Run, folder: str | Path) -> list[Path]:
    """Write how the search of a run went: ID-convergence.png and .svg."""
    from ..reporting.convergence_figure import convergence_figure
    from ..reporting.image import write_ink

    metric = str((of.head.get("objective") or {}).get("metric", ""))
    result = of.body.get("result", {})
    title = f"{of.head['name']}: search, {result.get('algorithm', '')}, seed {of.head['seed']}"
    count = int(result.get("evaluations", 0))
    ink = convergence_figure(of.body.get("trace", ()), metric, count, title)
    return write_ink(ink, Path(folder), f"{of.id}-convergence")
