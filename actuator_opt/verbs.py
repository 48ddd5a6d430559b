"""The verbs of the library: read, check, evaluate, optimise, sensitivity, report, save."""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from .design import Design, LoadedDesign, Source, read_design, with_values
from .errors import Diagnostic, InputError, UsageError
from .evaluation import Evaluation, Subject, compute, prepare
from .evaluation import evaluate as evaluate_subject
from .evaluation.plugin import Plugin, View, collect, load
from .quantities import METRICS

if TYPE_CHECKING:
    from .evaluation.rings import Place
    from .evaluation.study.seal import SealStudy
    from .optimisation.result import Optimisation, Sensitivity
    from .reporting import ExtraTable, ReportFile

_LAST_SECOND = 253_402_300_799
"""End of the year 9999, the last a date can hold."""

Plugins = Iterable["Plugin | Callable[[View], object] | str | Path"]


@dataclass(frozen=True, slots=True)
class Actuator:
    """A design as read: the design, where its values stand, and the user's own metrics."""

    design: Design
    source: Source | None = None
    plugins: tuple[Plugin, ...] = ()

    def subject(self) -> Subject:
        """The design with its materials and numbers, ready for the models."""
        return prepare(self.design, plugins=self.plugins)

    def changed(self, values: Mapping[str, float | str]) -> Actuator:
        """The same actuator with other numbers by PATH (SI, or text with a unit)."""
        known = METRICS | {plugin.name: plugin.quantity for plugin in self.plugins}
        design = with_values(self.design, dict(values), metrics=known)
        return Actuator(design, self.source, self.plugins)


def _plugins(given: Plugins) -> tuple[Plugin, ...]:
    found: list[Plugin] = []
    for item in given:
        if isinstance(item, Plugin):
            found.append(item)
        elif isinstance(item, (str, Path)):
            found += load(item)
        else:
            found += collect(item)
    names = [plugin.name for plugin in found]
    twice = next((name for name in names if names.count(name) > 1), None)
    if twice is not None:
        raise InputError(Diagnostic(f"the metric {twice} is declared twice", "rename one of them"))
    return tuple(found)


def read(
    source: str | Path,
    *,
    set: Mapping[str, str | float] | Sequence[tuple[str, str]] = (),
    plugins: Plugins = (),
) -> Actuator:
    """Read a design file (a path, ``"-"`` for standard input, or the text itself).

    Parameters
    ----------
    source : path or text
    set : values to replace, by PATH; a bare number is SI
    plugins : the user's metrics and constraints: decorated functions or Python files

    Raises
    ------
    InputError
        with every fault of the file, each with its place and remedy
    """
    own = _plugins(plugins)
    pairs = set.items() if isinstance(set, Mapping) else set
    loaded: LoadedDesign = read_design(
        source,
        overrides=[(path, str(value)) for path, value in pairs],
        metrics=METRICS | {plugin.name: plugin.quantity for plugin in own},
    )
    return Actuator(loaded.design, loaded.source, own)


def _actuator(design: Actuator | Design | str | Path, plugins: Plugins = ()) -> Actuator:
    if isinstance(design, Actuator):
        return design
    if isinstance(design, Design):
        return Actuator(design, None, _plugins(plugins))
    return read(design, plugins=plugins)


def check(
    source: str | Path,
    *,
    set: Mapping[str, str | float] | Sequence[tuple[str, str]] = (),
    plugins: Plugins = (),
) -> list[Diagnostic]:
    """All faults of a design file; an empty list for a good one. Parameters as `read`.

    Found too: variables that no model reads, requirements that no model answers.
    """
    try:
        actuator = read(source, set=set, plugins=plugins)
        subject = actuator.subject()
        faults = _unanswered(actuator, subject)
        if faults:
            return faults
        if actuator.design.choices:
            from .optimisation.choices import possible

            possible(subject)
        elif actuator.design.variables:
            from .optimisation.actuator import build

            build(subject, _fault(actuator))
    except InputError as error:
        return error.diagnostics
    return []


def _fault(actuator: Actuator) -> Callable[[str, str, str], Diagnostic] | None:
    return None if actuator.source is None else actuator.source.of_variable


def _unanswered(actuator: Actuator, subject: Subject) -> list[Diagnostic]:
    """Requirements on metrics that this design does not have."""
    if not actuator.design.requirements:
        return []
    computed = compute(subject, subject.values()).computed
    faults = []
    for metric, limit in actuator.design.requirements.items():
        if computed.metrics.get(metric):
            continue
        path = f"requirements.{metric}.{'max' if limit.min is None else 'min'}"
        message = f"cannot be met: {computed.why.get(metric, 'it does not apply to this design')}"
        remedy = "remove the requirement, or add what it needs"
        source = actuator.source
        place = source.diagnostic(path, message, remedy) if source is not None else None
        faults.append(place or Diagnostic(message, remedy, path=path))
    return faults


def evaluate(design: Actuator | Design | str | Path, *, plugins: Plugins = ()) -> Evaluation:
    """Every metric, requirement and check of a design as it stands."""
    return evaluate_subject(_actuator(design, plugins).subject())


def optimise(
    design: Actuator | Design | str | Path,
    *,
    algorithm: str = "auto",
    starts: int = 6,
    seed: int = 0,
    plugins: Plugins = (),
    prices: bool = True,
    max_seconds: float | None = None,
    whole_plies: bool = False,
) -> Optimisation:
    """The best design; parameters as `optimise.run.optimise`."""
    from .optimisation.run import optimise as run

    actuator = _actuator(design, plugins)
    subject = actuator.subject()
    faults = _unanswered(actuator, subject)
    if faults:
        raise InputError(faults)
    return run(
        subject,
        fault=_fault(actuator),
        algorithm=algorithm,
        starts=starts,
        seed=seed,
        prices=prices,
        max_seconds=max_seconds,
        whole_plies=whole_plies,
    )


def sensitivity(
    design: Actuator | Design | str | Path, *, seed: int = 0, plugins: Plugins = ()
) -> tuple[Sensitivity, ...]:
    """What each requirement and parameter costs at the design's optimum."""
    return optimise(design, seed=seed, plugins=plugins).sensitivities


def seal(
    design: Actuator | Design | str | Path,
    *,
    place: Place,
    speed: float | None = None,
    pressure: float | None = None,
    curves: bool = False,
    mapped: bool = False,
    finite_elements: bool = False,
) -> SealStudy:
    """Contact, oil film, friction, leakage and damping of the seals of piston or rod.

    The film is solved whether the design asks for it or for a coefficient of friction.

    Parameters
    ----------
    design : as `evaluate`
    place : "piston" or "rod"
    speed, pressure : of the counterface [m/s], sealed gauge [Pa]; default: those of the moving
        load case of the highest pressure
    curves : whether to follow friction over speed at three pressures
    mapped : whether to fill a map over speed and pressure
    finite_elements : whether to compute the contact profiles of O-rings and step rings (extra
        ``fem``); the study's design states them

    Raises
    ------
    InputError
        no speed above zero, or a pressure beyond the stated contact profiles
    ActuatorError
        no finite elements of this seal, or no balance
    """
    from .evaluation.study.seal import study, with_elements

    actuator = _actuator(design)
    elements = getattr(actuator.design.seals, place).elements()
    asked = {f"seals.{place}.{tail}friction": "film" for tail in elements}
    subject = actuator.changed(asked).subject()
    subject, found = with_elements(subject, place) if finite_elements else (subject, ())
    return study(
        subject,
        place,
        speed=speed,
        pressure=pressure,
        curves=curves,
        mapped=mapped,
        elements=found,
    )


def with_contact(actuator: Actuator, study: SealStudy) -> Actuator:
    """The actuator as read, with the contact profiles its seal was studied with."""
    seals = actuator.design.seals
    found = getattr(study.design.seals, study.place).contact
    seal = getattr(seals, study.place).model_copy(update={"contact": found})
    own = seals.model_copy(update={study.place: seal})
    design = actuator.design.model_copy(update={"seals": own})
    return Actuator(design, actuator.source, actuator.plugins)


def write_seal(
    study: SealStudy,
    *,
    folder: str | Path = "reports",
    actuator: Actuator | None = None,
    command: str = "",
    date: str | None = None,
    sheet: bool = True,
) -> list[ReportFile]:
    """Write the sheet of a seal (PDF and PNG), and its map as CSV where it has one.

    Parameters
    ----------
    study : what `seal` told
    folder : where to
    actuator : the design as read, for the attachment
    command, date : as `report`
    sheet : whether to write the sheet, or the map alone
    """
    from .design.writer import to_yaml
    from .evaluation.build import spec_hash
    from .reporting.seal_document import write_map, write_sheet

    source = None if actuator is None else actuator.source
    name = _file_name(study.design, source)
    stem = f"{Path(name).stem}_{study.place}_seal"
    files = []
    if sheet:
        files += write_sheet(
            study,
            folder=Path(folder),
            stem=stem,
            source_text=source.text if source is not None else to_yaml(study.design),
            source_name=name,
            command=command,
            spec_hash=spec_hash(prepare(study.design)),
            date=date or date_from_environment(),
        )
    if study.map is not None:
        files.append(write_map(study.map, Path(folder) / f"{stem}_map.csv"))
    return files


def _seal_studies(subject: Subject) -> list[SealStudy]:
    """The seal sheets of a report: every place of the design that asks for an oil film."""
    from .evaluation.study.seal import study

    places: tuple[Place, ...] = ("piston", "rod")
    asked = [x for x in places if getattr(subject.design.seals, x).friction == "film"]
    moving = any(case.speed > 0 for case in subject.design.load_cases)
    return [study(subject, x, curves=True, mapped=True) for x in asked if moving]


def report(
    subject: Evaluation | Optimisation,
    *,
    folder: str | Path = "reports",
    stem: str | None = None,
    actuator: Actuator | None = None,
    command: str = "",
    date: str | None = None,
    extra_tables: Sequence[ExtraTable] = (),
) -> list[ReportFile]:
    """Write the PDF and PNG report of an evaluation or an optimisation.

    Parameters
    ----------
    subject : what to report
    folder, stem : where to; default: the design's name in ``reports/``
    actuator : the design as read, for the input listing and attachment
    command : what made the report, printed on it
    date : ISO date; default: SOURCE_DATE_EPOCH, else none
    extra_tables : further tables
    """
    from .design.writer import to_yaml
    from .reporting import write_report
    from .reporting.published import published_tables

    source = None if actuator is None else actuator.source
    text = source.text if source is not None else to_yaml(subject.design)
    name = _file_name(subject.design, source)
    return write_report(
        subject,
        folder=Path(folder),
        stem=stem or Path(name).stem,
        source_text=text,
        source_name=name,
        command=command,
        date=date or date_from_environment(),
        extra_tables=[*published_tables(subject), *extra_tables],
        seals=_seal_studies(prepare(subject.design)),
    )


def _file_name(design: Design, source: Source | None) -> str:
    """Name of the design's file; of a design that came without one, its own name made fit."""
    if source is not None and not source.file.startswith("<"):
        return Path(source.file).name
    name = re.sub(r"[^\w-]+", "_", design.name).strip("_")
    return f"{name or 'design'}.yaml"


def date_from_environment() -> str | None:
    """The date of SOURCE_DATE_EPOCH (UTC), or None.

    Raises
    ------
    UsageError : it is no count of seconds
    """
    stamp = os.environ.get("SOURCE_DATE_EPOCH", "").strip()
    if not stamp:
        return None
    digits = stamp.isdecimal() and stamp.isascii() and len(stamp) <= 12
    if not digits or int(stamp) > _LAST_SECOND:
        message = f'SOURCE_DATE_EPOCH "{stamp[:40]}" is no count of seconds since 1970'
        raise UsageError(Diagnostic(message, "write e.g. 1700000000, or unset it"))
    from datetime import UTC, datetime

    return datetime.fromtimestamp(int(stamp), UTC).date().isoformat()


def save(design: Actuator | Design, path: str | Path, *, source: Source | None = None) -> Path:
    """Write a design file that keeps full precision, comments and order where it can."""
    from .design.writer import to_yaml
    from .store import write_text

    if isinstance(design, Actuator):
        source = source or design.source
        design = design.design
    return write_text(Path(path), to_yaml(design, source))
