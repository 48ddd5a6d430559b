"""Scenario files: read like designs, and together with the design they name."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ...base.errors import Diagnostic, Fault, InputError
from ...base.quantities import RESULTS, Quantity
from ...metrics import METRICS
from ..build import check
from ..kinds import ValueFault
from ..model import Design
from ..paths import resolve
from ..reader import STDIN, TEXT, LoadedDesign, Override, Source, load, opened, read_design
from ..section import Section
from ..structure import entries
from ..view import Materials
from ..yaml_source import parse
from .faults import cross_field, design_faults
from .model import Scenario


@dataclass(frozen=True, slots=True)
class LoadedScenario:
    """A scenario, its source, and its changes to the design."""

    scenario: Scenario
    source: Source
    folder: Path
    """Folder of the named files: that of the scenario file."""
    changes: tuple[Override, ...] = ()
    """Changed values of the design; those of the command line come last."""

    @property
    def design_file(self) -> Path:
        """The design file that the scenario names."""
        return self.folder / self.scenario.design

    def diagnostic(self, path: str, message: str, remedy: str = "") -> Diagnostic:
        """A fault of the value at a PATH of the scenario."""
        return self.source.diagnostic(path, message, remedy)


def read_scenario(
    source: str | Path, *, overrides: Iterable[tuple[str, str]] = ()
) -> LoadedScenario:
    """Read a scenario file, or its text; the design is not read.

    Parameters
    ----------
    source : path, ``"-"`` for standard input, or a text of several lines
    overrides : (PATH, value) pairs that replace values before all checks; a bare number is SI.
        PATHs that exist only in a design change the design, like those under ``set``

    Raises
    ------
    InputError
        with all faults, in line order
    """
    text, file = opened(source, "scenario")
    document = parse(text, file, "scenario")
    own: list[tuple[str, str]] = []
    others: list[tuple[str, str]] = []
    for path, value in overrides:
        (others if _of_design(path, document.data) else own).append((path, value))
    scenario, place = load(document, Scenario, _made, own, RESULTS)
    changes = []
    for path, value in scenario.set.items():
        loc = ("set", path)
        said = None if loc in place.overrides else document
        changes.append(Override(path, value, said, () if said is None else loc))
    changes += [Override(path, value) for path, value in others]
    folder = Path() if file in (TEXT, STDIN) else Path(source).parent
    return LoadedScenario(scenario, place, folder, tuple(changes))


def _made(tree: dict[str, Any]) -> tuple[Scenario | None, Sequence[Fault]]:
    checked = check(tree, Scenario, RESULTS, cross_field)
    return checked.section, checked.faults


def _of_design(path: str, tree: Any) -> bool:
    """Whether a PATH names a value of the design and not of the scenario."""
    head = re.split(r"[.\[]", path.strip(), maxsplit=1)[0]
    if head not in entries(Scenario):
        return head in entries(Design)
    return not _names(path, tree, RESULTS, Scenario) and _names(path, {}, METRICS, Design)


def _names(path: str, tree: Any, metrics: Mapping[str, Quantity], root: type[Section]) -> bool:
    try:
        resolve(path, tree, metrics, root)
    except ValueFault:
        return False
    return True


def read_design_of(
    loaded: LoadedScenario,
    *,
    materials: Materials | None = None,
    metrics: Mapping[str, Quantity] | None = None,
) -> LoadedDesign:
    """Read the design that a scenario names, with the scenario's changes.

    Parameters
    ----------
    loaded : the scenario
    materials : names and kinds of materials; default: the library
    metrics : metrics the design may name; default: `metrics.METRICS`

    Raises
    ------
    InputError
        with all faults of the design, those of changed values at their place in the scenario;
        otherwise with all contradictions between the two
    """
    path = loaded.design_file
    try:
        design = read_design(path, overrides=loaded.changes, materials=materials, metrics=metrics)
    except InputError as error:
        raise InputError([_at_its_name(fault, loaded) for fault in error.diagnostics]) from None
    found = sorted(design_faults(loaded.scenario, design.design), key=loaded.source.place)
    if found:
        raise InputError([loaded.source.at(fault) for fault in found])
    return design


def _at_its_name(fault: Diagnostic, loaded: LoadedScenario) -> Diagnostic:
    """Move a fault of a whole design file to the line of the scenario that names it."""
    path = str(loaded.design_file)
    if fault.file != path or fault.line is not None:
        return fault
    return loaded.diagnostic("design", f"{path}: {fault.message}", fault.remedy)
