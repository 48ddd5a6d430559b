"""Run records: input and outcome of runs, listed and read back.

Required form of the fields of a run record and of a report's attachment.

Either may be damaged, or written by someone else.
"""

from __future__ import annotations

import hashlib
import os
import platform
import re
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from importlib import metadata
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, Unpack

from ..base import runs as run_store
from ..base.errors import Diagnostic, InputError
from ..base.tables import Displayed
from ..evaluation.plugin import Plugin
from ..version import VERSION
from .actuator import Actuator
from .reports import date_from_environment, file_name, verification_tables

if TYPE_CHECKING:
    from ..optimisation.pareto import ParetoFront
    from ..optimisation.result import Optimisation
    from ..pages import Table
    from ..rendering.console import Style
    from ..simulation.verification import Verification
    from ..sweeps import Swept


Form = Any
"""A type, a tuple of alternative forms, ``[form]`` for a list of any length, or an object: fields
by name (``name?`` is optional, others are allowed), or ``{"*": form}`` for any names. ``float``
also accepts whole numbers, None is null, ``object`` is anything."""
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
    """The fault of the facts attached to a report; "" if there is none."""
    return _fault(run, _RUN)


def head_fault(head: object) -> str:
    """The fault of the head of a record; "" if there is none.

    >>> head_fault({"kind": 3})
    'kind must be text'
    """
    found = _fault(head, _HEAD)
    if found or not isinstance(head, Mapping):
        return found
    return _fault(head, _HEADS.get(head["kind"], {}))


def body_fault(kind: str, body: object) -> str:
    """The fault of the body of a record of this kind; "" if there is none."""
    return _fault(body, _BODY) or _fault(body, _BODIES.get(kind, {}))


_WORDS = {str: "text", int: "a whole number", bool: "true or false", float: "a number"}


def _fault(value: object, form: Form, path: str = "") -> str:
    """Where a value deviates from a form, and what is expected; "" if it fits."""
    if isinstance(form, tuple):
        found = [_fault(value, one, path) for one in form]
        return "" if "" in found else found[0]
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
    wanted = (int, float) if form is float else form
    if isinstance(value, wanted) and (form in (bool, object) or not isinstance(value, bool)):
        return ""
    return f"{path} must be {_WORDS[form]}"


def _object_fault(value: object, form: dict[str, Form], path: str) -> str:
    """`_fault` for an object."""
    if not isinstance(value, dict):
        return f"{path or 'it'} must be an object"
    head = f"{path}." if path else ""
    if "*" in form:
        found = (_fault(below, form["*"], f"{head}{name}") for name, below in value.items())
        return next(filter(None, found), "")
    for key, below in form.items():
        name = key.removesuffix("?")
        if name in value:
            fault = _fault(value[name], below, f"{head}{name}")
            if fault:
                return fault
        elif name == key:
            return f"{head}{name} is missing"
    return ""


_STATED = re.compile(r"^Version: *(\S+)", re.MULTILINE)
CLOSE = 1e-9
"""Relative difference up to which a number counts as reproduced: a choice, far above rounding."""


@dataclass(frozen=True, slots=True)
class Run(Displayed):
    """A recorded run: `head` is shown in lists, `body` has input, versions and result."""

    id: str
    path: Path
    head: Mapping[str, Any]
    body: Mapping[str, Any]

    def to_dict(self) -> dict[str, Any]:
        """The `runs show --json` object."""
        kept = {key: value for key, value in self.body.items() if key not in ("state", "tables")}
        return {"id": self.id, "path": str(self.path)} | dict(self.head) | kept

    def text(self, **style: Unpack[Style]) -> str:
        """Return the terminal text."""
        from ..pages.runs import blocks
        from ..rendering.terminal import blocks_text

        with sound(self):
            return blocks_text(blocks(self.id, self.head, self.body), **style)


@contextmanager
def sound(run: Run) -> Iterator[None]:
    """Report missing or malformed parts of a record in one line."""
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


def _damaged(what: str, path: Path) -> Diagnostic:
    return Diagnostic(f"is damaged ({what})", "run it again", str(path))


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
    head : its outcome in a few plain numbers and words, which lists show
    body : everything else, as plain data
    actuator, command, date, folder : as `record`
    seed : of the run

    Returns
    -------
    the record; None if recording is switched off (ACTUATOR_OPT_NO_RECORD)

    Raises
    ------
    InputError : it cannot be written
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
            "plugins": _plugins(actuator.plugins),
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


def _plugins(plugins: Sequence[Plugin]) -> list[dict[str, str]]:
    """The Python files of plugins, each once; "" means functions of a script."""
    files = dict.fromkeys(plugin.file for plugin in plugins)
    return [{"file": os.path.abspath(x) if x else x, "sha256": sha256(x)} for x in files]


def sha256(file: str) -> str:
    """Hash of a file; "" if it cannot be read."""
    try:
        return hashlib.sha256(Path(file).read_bytes()).hexdigest()
    except OSError:
        return ""


def _versions() -> dict[str, str]:
    found = {"actuator-opt": VERSION, "python": platform.python_version()}
    for name in ("numpy", "scipy", "nlopt", "cvxpy", "matplotlib", "typst"):
        try:
            package = metadata.distribution(name)
        except metadata.PackageNotFoundError:
            continue
        head = _STATED.search(package.read_text("METADATA") or "")  # a full parse takes 4 ms
        found[name] = package.version if head is None else head[1]
    return found


def runs(
    *,
    design: str | None = None,
    command: str | None = None,
    folder: str | Path | None = None,
) -> tuple[list[run_store.StoredRun], list[Diagnostic]]:
    """Recorded runs, newest first, and faults of records that cannot be read.

    Parameters
    ----------
    design : only runs of a design with this name or file
    command : only those of this command (``optimise``, ``pareto``, ``sweep``)
    folder : location of the records; default as `record`
    """
    place = run_store.folder() if folder is None else Path(folder)
    if place is None:
        return [], []
    every, faults = run_store.entries(place)
    wrong = {entry.id: head_fault(entry.head) for entry in every}
    faults += [_damaged(wrong[entry.id], entry.path) for entry in every if wrong[entry.id]]
    found = [entry for entry in every if not wrong[entry.id]]
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
    """A recorded run by its id or the start of one, ``last``, or its file.

    Raises
    ------
    InputError : none, several, a damaged or a newer one
    """
    place = run_store.folder() if folder is None else Path(folder)
    path = run_store.find(place, str(name))
    head, body = run_store.read(path)
    fault = head_fault(head) or body_fault(head["kind"], body)
    if fault:
        raise InputError(_damaged(fault, path))
    return Run(path.stem, path, head, body)


def delete_run(name: str, *, folder: str | Path | None = None) -> str:
    """Delete a recorded run and return its id. Parameters as `read_run`."""
    path = run_store.find(run_store.folder() if folder is None else Path(folder), name)
    if not run_store.is_record(path):
        remedy = "write its id"
        raise InputError(Diagnostic("is not a record of a run", remedy, str(path)))
    if not run_store.delete(path):
        raise InputError(Diagnostic("no such file", "see: actuator-opt runs list", str(path)))
    return path.stem


def prune_runs(*, keep: int, folder: str | Path | None = None) -> list[str]:
    """Delete all runs but the newest `keep`; ids of those this call deleted."""
    place = run_store.folder() if folder is None else Path(folder)
    if place is None:
        return []
    found, _ = run_store.entries(place)
    return [entry.id for entry in found[keep:] if run_store.delete(entry.path)]


def differing(then: Mapping[str, Any], now: Mapping[str, Any]) -> list[str]:
    """Names whose numbers differ by more than `CLOSE`, or that only one side has."""
    names = dict.fromkeys([*then, *now])
    return [name for name in names if not same(then.get(name), now.get(name))]


def same(a: Any, b: Any) -> bool:
    """Whether two values are equal, numbers within `CLOSE`."""
    if isinstance(a, (int, float)) and isinstance(b, (int, float)):
        return abs(a - b) <= CLOSE * max(abs(a), abs(b))
    return bool(a == b)


BEST = 10
"""Maximum number of best designs in a sweep's record; the store has all rows."""
REASONS = 20
"""Number of failure reasons recorded, most frequent first."""


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
    """Record an optimisation with its input, for showing and reporting it later.

    Parameters
    ----------
    result : of `optimise`
    actuator : the design optimised
    command, date, extra_tables, dynamics_verified : of its report
    folder : target; default: ACTUATOR_OPT_RUNS, else the user's data folder

    Returns
    -------
    the record; None if recording is switched off (ACTUATOR_OPT_NO_RECORD)

    Raises
    ------
    InputError : it cannot be written
    """
    from ..optimisation.recorded import to_plain

    head = {
        "status": result.status,
        "outcome": result.sentence,
        "met": result.best_evaluation.met and (result.rounding is None or result.rounding.met),
        "without_reserve": len(result.tight),
        "objective": result.to_dict()["objective"],
        "seconds": result.seconds,
    }
    more = {
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
        "optimise", head, more, actuator=actuator, command=command, date=date,
        seed=result.seed, folder=folder,
    )  # fmt: skip


def _plain_table(table: Table) -> dict[str, object]:
    """A table of a report as a record holds it: texts under their heads."""
    from ..rendering.heights import cells_of, joined

    flexible = all(column.flexible for column in table.columns)
    return {
        "title": table.title,
        "columns": [column.head for column in table.columns],
        "rows": [[joined(cell) for cell in cells_of(row)] for row in table.rows],
        "note": table.note,
        "widths": [column.width for column in table.columns] if flexible else [],
    }


def record_front(
    found: ParetoFront,
    *,
    actuator: Actuator,
    command: str = "",
    date: str | None = None,
    folder: str | Path | None = None,
) -> Run | None:
    """Record a Pareto front, for showing and reporting it later; as `record`."""
    from ..optimisation.recorded import to_plain

    knee = None if found.knee is None else found.knee.index
    head = {
        "status": found.status,
        "outcome": found.sentence,
        "met": bool(found.points),
        "objectives": [
            {"metric": objective.metric, "sense": objective.sense} for objective in found.objectives
        ],
        "points": len(found.points),
        "knee": None
        if knee is None
        else {
            objective.metric: found.points[knee].metrics[objective.metric]
            for objective in found.objectives
        },
        "seconds": found.seconds,
    }
    more = {"result": found.to_dict(), "state": to_plain(found)}
    return record_run(
        "pareto", head, more, actuator=actuator, command=command, date=date,
        seed=found.seed, folder=folder,
    )  # fmt: skip


def record_sweep(
    found: Swept,
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
    """Record a sweep: plan, counts, best designs and the location of its rows, but no rows.

    Parameters
    ----------
    found : of `sweep`
    actuator, command, date, folder : as `record`
    store, csv, parquet, keep, figures, show : as given to `sweep`
    """
    from ..pages.sweep import counts

    study = found.study
    goal, met = study.goal, bool(found.best or found.feasible)
    best = None
    if found.best:
        first = found.best[0].objective
        best = found.metrics(found.best[0])[goal.single] if goal.single else goal.shown(first)
    head = {
        "status": "feasible" if met else "infeasible",
        "outcome": f"{found.requested} variants: {counts(found)}",
        "met": met,
        "objective": {"metric": goal.single or "weighted", "value": best},
        "requested": found.requested,
        "feasible": found.feasible,
        "failed": found.failed,
        "seconds": found.seconds,
    }
    commonest = sorted(found.failures.items(), key=lambda one: (-one[1], one[0]))[:REASONS]
    kept = replace(found, best=found.best[:BEST], failures=dict(commonest))
    more: dict[str, Any] = {
        "plan": _plan(found),
        "asked": {
            "store": None
            if store is None
            else {"path": os.path.abspath(store), "study": study.hash},
            "csv": None if csv is None else os.path.abspath(csv),
            "parquet": None if parquet is None else os.path.abspath(parquet),
            "reduce": not study.full,
            "engine": study.engine,
            "keep": keep,
            "figures": list(figures),
            "show": list(show),
        },
        "result": kept.to_dict(),
    }
    return record_run(
        "sweep", head, more, actuator=actuator, command=command, date=date,
        seed=study.plan.seed, folder=folder,
    )  # fmt: skip


def _plan(swept: Swept) -> dict[str, Any]:
    """The points of a sweep as plain data, values in SI; `quantity` is null for texts."""
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
