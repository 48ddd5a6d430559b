"""Run records: input and outcome of runs, listed and read back."""

from __future__ import annotations

import hashlib
import os
import platform
import re
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from datetime import UTC, datetime
from importlib import metadata
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, Unpack

from ..base import runs as run_store
from ..base.errors import Diagnostic, InputError
from ..evaluation.plugin import Plugin
from ..version import VERSION
from .actuator import Actuator
from .record_form import body_fault, head_fault
from .reports import date_from_environment, file_name

if TYPE_CHECKING:
    from ..rendering.console import Style

_STATED = re.compile(r"^Version: *(\S+)", re.MULTILINE)
CLOSE = 1e-9
"""Relative difference up to which a number counts as reproduced: a choice, far above rounding."""


@dataclass(frozen=True, slots=True)
class Run:
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
) -> tuple[list[run_store.Entry], list[Diagnostic]]:
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
