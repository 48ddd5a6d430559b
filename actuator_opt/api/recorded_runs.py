"""Writes, lists, reads and deletes the records of runs.

A record, or the data attached to a report, may be damaged or come from another program. So its
fields are first checked against a required form.
"""

from __future__ import annotations

import hashlib
import os
import platform
import re
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from datetime import UTC, datetime
from importlib import metadata
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, Unpack

from ..base import runs as run_store
from ..base.arguments import guarded
from ..base.dataclass import dataclass
from ..base.errors import Diagnostic, InputError
from ..base.tables import Displayed
from ..evaluation.plugin import Plugin
from ..version import VERSION
from .actuator import Actuator
from .reports import date_from_environment, file_name, verification_tables

if TYPE_CHECKING:
    from ..design import FileSource
    from ..optimisation.pareto import ParetoFront
    from ..optimisation.result import Optimisation
    from ..pages import Table
    from ..rendering.console import Style
    from ..simulation.verification import Verification
    from ..sweeps import Swept


Form = Any
"""Required form of a value: a type, a tuple of alternative forms, or ``[form]`` for a list of any
length. An object's form is a dictionary of fields by name; ``name?`` is optional, and further
fields are allowed. ``{"*": form}`` permits any names. ``float`` also accepts whole numbers, None is
null, and ``object`` is anything."""
_OBJECTIVE = {"metric?": (str, None), "value?": (float, None)}
_HEAD: Form = {
    "kind": str,
    "name": str,
    "file": str,
    "started": str,
    "command": str,
    "version": str,
    "spec_hash": str,
    "seed": int,
    "status?": str,
    "outcome?": str,
    "met?": bool,
    "seconds?": float,
    "objective?": (_OBJECTIVE, None),
    "objectives?": [{"metric": str, "sense": str}],
    "points?": int,
    "knee?": ({"*": (float, None)}, None),
    "requested?": int,
    "feasible?": (int, None),
    "failed?": int,
}
_BODY: Form = {
    "date": (str, None),
    "input": {
        "name": str,
        "text": str,
        "set": [[str]],
        "unset?": [str],
        "files?": {"*": str},
        "plugins": [{"file": str, "sha256": str}],
    },
    "versions": {"*": str},
}
_STATE: Form = {"designs": [{}], "result": {}}
_AXIS: Form = {
    "path": str,
    "quantity": (str, None),
    "values": ([float], None),
    "texts": [str],
    "range": bool,
    "steps": (int, None),
}
_HEADS: Mapping[str, Form] = {
    "optimise": {"met": bool, "objective": _OBJECTIVE},
    "pareto": {"objectives": object, "points": object, "knee": object},
    "sweep": {"met": bool, "objective": {"metric": str}, "requested": object, "feasible": object},
}
_BODIES: Mapping[str, Form] = {
    "optimise": {
        "trace": [[float]],
        "result": {
            "metrics": {"*": {"value": (float, None)}},
            "algorithm": str,
            "evaluations": int,
        },
        "state": _STATE,
        "tables": [
            {"title": str, "columns": [str], "rows": [[object]], "note": str, "widths": [float]}
        ],
    },
    "pareto": {
        "result": {
            "metrics": {"*": {"value": (float, None)}},
            "points": [{"metrics": {"*": (float, None)}}],
        },
        "state": _STATE,
    },
    "sweep": {
        "plan": {"method": str, "count": int, "axes": [_AXIS]},
        "asked": {
            "store": ({"path": str, "study": str}, None),
            "csv": (str, None),
            "parquet": (str, None),
            "reduce": bool,
            "keep": int,
            "figures": [str],
            "show": [str],
        },
        "result": {
            "best": [{"variables": {"*": (float, str)}, "metrics": {"*": (float, None)}}],
        },
    },
}
_NUMBERS: Form = ({"*": (float, None)}, None)
_RUN: Form = {
    "actuator_opt": str,
    "command": str,
    "source_name": str,
    "date?": (str, None),
    "spec_hash?": str,
    "files?": {"*": str},
    "result?": (
        {
            "status?": (str, None),
            "spec_hash?": str,
            "metrics?": _NUMBERS,
            "variables?": _NUMBERS,
        },
        None,
    ),
}


def run_fault(run: object) -> str:
    """The fault of the data attached to a report, in words; "" if there is none."""
    return _fault(run, _RUN)


def head_fault(head: object) -> str:
    """The fault of a record's head (the part that lists show), in words; "" if there is none.

    >>> head_fault({"kind": 3})
    'kind must be text'
    """
    fault = _fault(head, _HEAD)
    if fault or not isinstance(head, Mapping):
        return fault
    return _fault(head, _HEADS.get(head["kind"], {}))


def body_fault(kind: str, body: object) -> str:
    """The fault of the body of a record of this kind, in words; "" if there is none."""
    return _fault(body, _BODY) or _fault(body, _BODIES.get(kind, {}))


_WORDS = {str: "text", int: "a whole number", bool: "true or false", float: "a number"}


def _fault(value: object, form: Form, path: str = "") -> str:
    """Where a value deviates from its required form, and what was expected there; "" if it fits."""
    if isinstance(form, tuple):
        faults = [_fault(value, alternative, path) for alternative in form]
        return "" if "" in faults else faults[0]
    if isinstance(form, list):
        if not isinstance(value, list):
            return f"{path} must be a list"
        return next(
            filter(None, (_fault(x, form[0], f"{path}[{k}]") for k, x in enumerate(value))), ""
        )
    if isinstance(form, dict):
        return _object_fault(value, form, path)
    if form is None:
        return "" if value is None else f"{path} must be null"
    expected_type = (int, float) if form is float else form
    if isinstance(value, expected_type) and (form in (bool, object) or not isinstance(value, bool)):
        return ""
    return f"{path} must be {_WORDS[form]}"


def _object_fault(value: object, form: dict[str, Form], path: str) -> str:
    """The result of `_fault` for a dictionary of fields."""
    if not isinstance(value, dict):
        return f"{path or 'it'} must be an object"
    head = f"{path}." if path else ""
    if "*" in form:
        faults = (_fault(field, form["*"], f"{head}{name}") for name, field in value.items())
        return next(filter(None, faults), "")
    for key, field in form.items():
        name = key.removesuffix("?")
        if name in value:
            fault = _fault(value[name], field, f"{head}{name}")
            if fault:
                return fault
        elif name == key:
            return f"{head}{name} is missing"
    return ""


_VERSION = re.compile(r"^Version: *(\S+)", re.MULTILINE)
CLOSE = 1e-9
"""Largest relative difference at which a number counts as reproduced: our choice, far above
rounding."""


@dataclass(frozen=True, slots=True)
class Run(Displayed):
    """A recorded run: `head` is shown in lists; `body` has input, versions and result."""

    id: str
    path: Path
    head: Mapping[str, Any]
    body: Mapping[str, Any]

    @property
    def in_short(self) -> tuple[str, str]:
        """The command and its design."""
        kind, name = (str(self.head.get(key, "")) for key in ("kind", "name"))
        return self.id, f"{kind} of {name}"

    def to_dict(self) -> dict[str, Any]:
        """The object of `runs show --json`."""
        body = {key: value for key, value in self.body.items() if key not in ("state", "tables")}
        return {"id": self.id, "path": str(self.path)} | dict(self.head) | body

    def text(self, **style: Unpack[Style]) -> str:
        """The text for the terminal."""
        from ..pages.runs import blocks
        from ..rendering.terminal import blocks_text

        with damage_reported(self):
            return blocks_text(blocks(self.id, self.head, self.body), **style)


@contextmanager
def damage_reported(run: Run) -> Iterator[None]:
    """Report missing or malformed parts of a record as an error in one line."""
    try:
        yield
    except (
        LookupError,
        TypeError,
        ValueError,
        AttributeError,
        ArithmeticError,
        RecursionError,
        AssertionError,
    ) as error:
        raise InputError(_damaged(type(error).__name__, run.path)) from None


def _damaged(reason: str, path: Path) -> Diagnostic:
    return Diagnostic(f"is damaged ({reason})", "run it again", str(path))


@guarded
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
    """Record a run of any command.

    Parameters
    ----------
    kind : the command
    head : outcome of the run, as a few plain numbers and words that lists show
    body : all other results of the run, as plain data
    actuator, command, date, folder : as for `record`
    seed : seed of the run

    Returns
    -------
    the recorded run; None if recording is switched off (ACTUATOR_OPT_NO_RECORD)

    Raises
    ------
    InputError : the record cannot be written
    """
    from ..design.writer import to_yaml
    from ..evaluation.build import spec_hash

    place = _folder(folder)
    if place is None:
        return None
    design, source = actuator.design, actuator.source
    started = _started()
    common_head = {
        "kind": kind,
        "name": actuator.design.name,
        "file": file_name(actuator.design, source),
        "started": started.isoformat(timespec="seconds").replace("+00:00", "Z"),
        "command": command,
        "version": VERSION,
        "spec_hash": spec_hash(actuator.subject()),
        "seed": seed,
    }
    text = to_yaml(design) if source is None else source.text
    common_body = {
        "date": date or date_from_environment(),
        "input": {
            "name": file_name(actuator.design, source),
            "text": text,
            **_changes(source),
            **_files(actuator),
            "plugins": _plugins(actuator.plugins),
        },
        "versions": _versions(),
    }
    head, body = common_head | dict(head), common_body | dict(body)
    path = run_store.write(place, f"{started:%Y%m%d-%H%M%S}", head, body)
    return Run(path.stem, path, head, body)


def _files(actuator: Actuator) -> dict[str, dict[str, str]]:
    """Texts of the data files that a design names, if it names any."""
    from ..design.data_file import texts_of

    files = texts_of(actuator.design)
    return {"files": files} if files else {}


def _changes(source: FileSource | None) -> dict[str, Any]:
    """Values of the design that the command line set, and keys that it removed, if any."""
    changes = () if source is None else source.overrides.values()
    unset = [x.path for x in changes if x.value is None]
    values = [[x.path, x.value] for x in changes if x.value is not None]
    return {"set": values} | ({"unset": unset} if unset else {})


def _folder(folder: str | Path | None) -> Path | None:
    """Folder of the run records; None if recording is switched off."""
    return run_store.folder() if folder is None else Path(folder)


def _started() -> datetime:
    """The present time, or that of SOURCE_DATE_EPOCH, in whole seconds of UTC."""
    if date_from_environment() is not None:
        return datetime.fromtimestamp(int(os.environ["SOURCE_DATE_EPOCH"]), UTC)
    return datetime.now(UTC).replace(microsecond=0)


def _plugins(plugins: Sequence[Plugin]) -> list[dict[str, str]]:
    """The Python files of plugins, each once; "" represents functions defined in a script."""
    files = dict.fromkeys(plugin.file for plugin in plugins)
    return [{"file": os.path.abspath(x) if x else x, "sha256": sha256(x)} for x in files]


def sha256(file: str) -> str:
    """Hash of a file; "" if it cannot be read."""
    try:
        return hashlib.sha256(Path(file).read_bytes()).hexdigest()
    except OSError:
        return ""


def _versions() -> dict[str, str]:
    versions = {"actuator-opt": VERSION, "python": platform.python_version()}
    for name in ("numpy", "scipy", "nlopt", "cvxpy", "matplotlib", "typst"):
        try:
            package = metadata.distribution(name)
        except metadata.PackageNotFoundError:
            continue
        version = _VERSION.search(package.read_text("METADATA") or "")  # a full parse takes 4 ms
        versions[name] = package.version if version is None else version[1]
    return versions


@guarded
def runs(
    *,
    design: str | None = None,
    command: str | None = None,
    folder: str | Path | None = None,
) -> tuple[list[run_store.StoredRun], list[Diagnostic]]:
    """Recorded runs, newest first, and faults of the records that cannot be read.

    Parameters
    ----------
    design : only runs of a design with this name or file
    command : only runs of this command (``optimise``, ``pareto``, ``sweep``)
    folder : folder of the records; default as for `record`
    """
    place = _folder(folder)
    if place is None:
        return [], []
    entries, faults = run_store.entries(place)
    if command == "optimize":
        command = "optimise"
    stem = None if design is None else Path(design).name
    selected = []
    for entry in entries:
        fault = head_fault(entry.head)
        if fault:
            faults.append(_damaged(fault, entry.path))
        elif (command is None or entry.head.get("kind") == command) and (
            stem is None or stem in _names(entry.head)
        ):
            selected.append(entry)
    return selected, faults


def _names(head: Mapping[str, Any]) -> tuple[str, ...]:
    file = str(head.get("file", ""))
    return (str(head.get("name", "")), file, Path(file).stem)


@guarded
def read_run(name: str | Path, *, folder: str | Path | None = None) -> Run:
    """Read a recorded run, given its id, the start of its id, ``last``, or its file.

    Raises
    ------
    InputError : no run or several runs match, or the record is damaged or from a newer version
    """
    path = run_store.find(_folder(folder), str(name))
    head, body = run_store.read(path)
    fault = head_fault(head) or body_fault(head["kind"], body)
    if fault:
        raise InputError(_damaged(fault, path))
    return Run(path.stem, path, head, body)


@guarded
def delete_run(name: str, *, folder: str | Path | None = None) -> str:
    """Delete a recorded run and return its id. Parameters as for `read_run`."""
    path = run_store.find(_folder(folder), name)
    if not run_store.is_record(path):
        remedy = "write its id"
        raise InputError(Diagnostic("is not a record of a run", remedy, str(path)))
    if not run_store.delete(path):
        raise InputError(Diagnostic("no such file", "see: actuator-opt runs list", str(path)))
    return path.stem


@guarded
def prune_runs(*, keep: int, folder: str | Path | None = None) -> list[str]:
    """Delete all runs except the newest `keep` runs; return the ids of the deleted runs."""
    place = _folder(folder)
    if place is None:
        return []
    entries, _ = run_store.entries(place)
    return [entry.id for entry in entries[keep:] if run_store.delete(entry.path)]


def differing(then: Mapping[str, Any], now: Mapping[str, Any]) -> list[str]:
    """Names of values that differ by more than `CLOSE`, or that only one mapping contains."""
    names = dict.fromkeys([*then, *now])
    return [name for name in names if not same(then.get(name), now.get(name))]


def same(a: Any, b: Any) -> bool:
    """Whether two values are equal; numbers may have a relative difference of at most `CLOSE`."""
    if isinstance(a, (int, float)) and isinstance(b, (int, float)):
        return abs(a - b) <= CLOSE * max(abs(a), abs(b))
    return bool(a == b)


BEST = 10
"""Maximum number of best designs in the record of a sweep; the database has all rows."""
REASONS = 20
"""Maximum number of failure reasons that are recorded, the most frequent first."""


@guarded
def record(
    result: Optimisation,
    *,
    actuator: Actuator,
    command: str = "",
    date: str | None = None,
    extra_tables: Sequence[Table] = (),
    dynamics_verified: Verification | None = None,
    folder: str | Path | None = None,
) -> Run | None:
    """Record an optimisation with its input, so that it can be shown and reported later.

    Parameters
    ----------
    result : result of `optimise`
    actuator : the design that was optimised
    command, date, extra_tables, dynamics_verified : as given for its report
    folder : folder of the records; default: ACTUATOR_OPT_RUNS, or else the user's data folder

    Returns
    -------
    the recorded run; None if recording is switched off (ACTUATOR_OPT_NO_RECORD)

    Raises
    ------
    InputError : the record cannot be written
    """
    from ..optimisation.stored_results import to_plain

    head = {
        "status": result.status,
        "outcome": result.sentence,
        "met": result.best_evaluation.met and (result.rounding is None or result.rounding.met),
        "without_reserve": len(result.tight),
        "objective": result.to_dict()["objective"],
        "seconds": result.seconds,
    }
    body = {
        "variables": {v.path: v.value for v in result.best_variables},
        "trace": [list(row) for row in result.trace],
        "result": result.to_dict(),
        "state": to_plain(result),
        "tables": [
            _plain_table(table)
            for table in (*extra_tables, *verification_tables(dynamics_verified))
        ],
    }
    return record_run(
        "optimise", head, body, actuator=actuator, command=command, date=date,
        seed=result.seed, folder=folder,
    )  # fmt: skip


def _plain_table(table: Table) -> dict[str, object]:
    """A report's table in the form that records use: lists of texts under their column heads."""
    from ..rendering.heights import cells_of, joined

    flexible = all(column.flexible for column in table.columns)
    return {
        "title": table.title,
        "columns": [column.head for column in table.columns],
        "rows": [[joined(cell) for cell in cells_of(row)] for row in table.rows],
        "note": table.note,
        "widths": [column.width for column in table.columns] if flexible else [],
    }


@guarded
def record_front(
    front: ParetoFront,
    *,
    actuator: Actuator,
    command: str = "",
    date: str | None = None,
    folder: str | Path | None = None,
) -> Run | None:
    """Record a Pareto front, to show and report it later; parameters as for `record`."""
    from ..optimisation.stored_results import to_plain

    objectives, knee = front.objectives, None
    if front.knee is not None:
        metrics = front.points[front.knee.index].metrics
        knee = {objective.metric: metrics[objective.metric] for objective in objectives}
    head = {
        "status": front.status,
        "outcome": front.sentence,
        "met": bool(front.points),
        "objectives": [{"metric": x.metric, "sense": x.sense} for x in objectives],
        "points": len(front.points),
        "knee": knee,
        "seconds": front.seconds,
    }
    body = {"result": front.to_dict(), "state": to_plain(front)}
    return record_run(
        "pareto", head, body, actuator=actuator, command=command, date=date,
        seed=front.seed, folder=folder,
    )  # fmt: skip


@guarded
def record_sweep(
    swept: Swept,
    *,
    actuator: Actuator,
    store: str | Path | None = None,
    csv: str | Path | None = None,
    parquet: str | Path | None = None,
    keep: int = 10,
    figures: Sequence[str] = (),
    show: Sequence[str] = (),
    command: str = "",
    date: str | None = None,
    folder: str | Path | None = None,
) -> Run | None:
    """Record a sweep: its plan, counts, best designs, and where its rows are stored.

    Parameters
    ----------
    swept : result of `sweep`
    actuator, command, date, folder : as for `record`
    store, csv, parquet, keep, figures, show : as given to `sweep`
    """
    from ..pages.sweep import counts

    study = swept.study
    goal, met = study.goal, bool(swept.best or swept.feasible)
    best = None
    if swept.best:
        first = swept.best[0].objective
        best = swept.metrics(swept.best[0])[goal.single] if goal.single else goal.shown(first)
    head = {
        "status": "feasible" if met else "infeasible",
        "outcome": f"{swept.requested} variants: {counts(swept)}",
        "met": met,
        "objective": {"metric": goal.single or "weighted", "value": best},
        "requested": swept.requested,
        "feasible": swept.feasible,
        "failed": swept.failed,
        "seconds": swept.seconds,
    }
    commonest = sorted(swept.failures.items(), key=lambda failure: (-failure[1], failure[0]))
    summary = replace(swept, best=swept.best[:BEST], failures=dict(commonest[:REASONS]))
    body: dict[str, Any] = {
        "plan": _plan(swept),
        "asked": {
            "store": store and {"path": os.path.abspath(store), "study": study.hash},
            "csv": csv and os.path.abspath(csv),
            "parquet": parquet and os.path.abspath(parquet),
            "reduce": not study.full,
            "engine": study.engine,
            "keep": keep,
            "figures": list(figures),
            "show": list(show),
        },
        "result": summary.to_dict(),
    }
    return record_run(
        "sweep", head, body, actuator=actuator, command=command, date=date,
        seed=study.plan.seed, folder=folder,
    )  # fmt: skip


def _plan(swept: Swept) -> dict[str, Any]:
    """The plan of a sweep as plain data, in SI; `quantity` is None for inputs with text values."""
    from ..design import quantity_of

    plan, design = swept.study.plan, swept.study.design
    return {
        "method": plan.method,
        "count": plan.count,
        "axes": [
            {
                "path": axis.path,
                "quantity": None if axis.values is None else quantity_of(axis.path, design).name,
                "values": None if axis.values is None else axis.values.tolist(),
                "texts": list(axis.texts),
                "range": axis.range,
                "steps": axis.count,
            }
            for axis in plan.axes
        ],
    }
