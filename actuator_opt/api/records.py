"""Test records: reads them, identifies parameters, and calibrates the design that was tested."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Unpack

from ..base.arguments import guarded
from ..base.dataclass import dataclass
from ..base.errors import Diagnostic, InputError
from ..base.tables import Displayed
from ..design import Design
from .actuator import Actuator, Result, as_actuator
from .reports import ReportArguments, page_of

if TYPE_CHECKING:
    from ..identification import BendingResult, Calibration, Identification, Record, Specimen
    from ..identification.bending import Part
    from ..optimisation.redesign import Redesign
    from ..pages import ReportFile
    from ..rendering.blocks import Page

MOST_BYTES = 1_000_000_000
"""Largest permitted file of a record [bytes]: our choice, because memory must hold it several
times."""
_NOT_TESTED = (
    "name",
    "notes",
    "variables",
    "choices",
    "requirements",
    "waivers",
    "objective",
    "measured",
)
"""Keys that do not describe the tested actuator; designs that differ only in them count as
equal."""
Units = str | Path | Mapping[str, str] | None
"""Units of columns without a unit in their header: ``"SI"``, a file, or a mapping by column."""


@guarded
def read_record(
    source: str | Path,
    *,
    columns: Mapping[str, str] | None = None,
    units: Units = None,
    needed: Collection[str] | None = None,
) -> Record:
    """Read the CSV file of a test record.

    Parameters
    ----------
    source : path, ``"-"`` for standard input
    columns : header of every channel whose header is not a known name, with a unit if the file
        states none: ``{"p1": "Channel 3 [bar]"}``
    units : units of columns without a unit in their header: ``"SI"`` (m, s, Pa, N, m/s, K), a file
        with lines ``p1: bar`` (YAML) or ``p1,bar``, or a mapping. A unit in the header takes
        precedence over ``"SI"`` and must agree with a unit stated for its column
    needed : channels that must have a unit; default: all except v and T. Any other channel without
        a unit is left out, with a note

    Returns
    -------
    the record, SI

    Raises
    ------
    InputError
        the file does not exist; a column is unknown or repeated; a unit is missing; or a cell is
        not a number
    """
    from ..base.sheets import read_text
    from ..identification import column_units, parse_record

    known_units = column_units(units)
    name = "<stdin>" if str(source) == "-" else str(source)
    text = read_text(source, most=MOST_BYTES)
    return parse_record(text, name=name, columns=columns, units=known_units, needed=needed)


@guarded
def identify(
    record: Record | str | Path,
    *,
    design: Actuator | Design | Result | str | Path,
    columns: Mapping[str, str] | None = None,
    units: Units = None,
    cutoff: float = 30.0,
    order: int = 4,
    compensated: bool = True,
    mass: float | None = None,
    load_force: float | None = None,
    pressure_lag: float | None = None,
    bootstrap: int = 0,
    seed: int = 0,
) -> Identification:
    """Identify friction and damping from a test record of the actuator.

    Friction follows from F_r = p_1 A_1 - p_2 A_2 - F_L - m a: chamber pressures p_1 and p_2 times
    areas A_1 and A_2, load force F_L, and mass m times acceleration a. The areas include the growth
    of the bore.

    Parameters
    ----------
    record : the record as read, or the path of its file
    design : the actuator as tested
    columns, units : as for `read_record`
    cutoff, order, compensated : cut-off frequency [Hz] and order of the zero-phase Butterworth
        filter. If compensated, both passes together have -3 dB at the cut-off; otherwise each pass
        has -3 dB there
    mass : mass that moves between the piston and the force sensor [kg]; default: the mass of rod,
        piston and fastening; if there is no force channel, the design's load is added
    load_force : load force that opposes extension [N], if no channel measures it
    pressure_lag : delay of the pressure signals behind the other signals [s]; None: fitted to the
        record
    bootstrap : number of resampled records for the confidence intervals; 0: intervals of the
        linearised model
    seed : seed of the resampling

    Returns
    -------
    the identification

    Raises
    ------
    InputError
        a channel is missing, the record is too short, signs are wrong, or nothing moves
    """
    from ..identification import Settings, identify as run
    from ..studies.bench import bench

    settings = Settings(
        cutoff=cutoff,
        order=order,
        compensated=compensated,
        mass=mass,
        load_force=load_force,
        pressure_lag=pressure_lag,
        bootstrap=bootstrap,
        seed=seed,
    )
    tested = bench(as_actuator(design).subject())
    needed = ("p1", "x", "F_L") if tested.plunger else ("p1", "p2", "x", "F_L")
    return run(_record(record, columns, units, needed), tested, settings)


def _record(
    record: Record | str | Path,
    columns: Mapping[str, str] | None,
    units: Units,
    needed: Collection[str],
) -> Record:
    """Read a record from its file; if it is already read, reject reading options."""
    if isinstance(record, (str, Path)):
        return read_record(record, columns=columns, units=units, needed=needed)
    for option, fault in ((columns, "columns are named"), (units, "units are stated")):
        if option:
            message = f"{fault}, but the record is already read"
            raise InputError(Diagnostic(message, "give them to read_record"))
    return record


@guarded
def bending(
    record: Record | str | Path,
    *,
    span: float | None = None,
    design: Actuator | Design | Result | str | Path | None = None,
    part: Part = "rod",
    specimen: Specimen | None = None,
    columns: Mapping[str, str] | None = None,
    units: Units = None,
) -> BendingResult:
    """Modulus of a part from a three-point bending test (force F_L, deflection w).

    Parameters
    ----------
    record : the record as read, or the path of its file
    span : distance between the supports [m]
    design, part : the design, and which of its parts is tested, "rod" or "barrel"; the shear
        modulus of a metal part is taken from the design
    specimen : the specimen, in place of span, design and part
    columns, units : as for `read_record`

    Raises
    ------
    InputError
        a channel is missing, the curve has no straight part, or no section is given
    """
    from ..identification import bending as run
    from ..identification.bending import specimen_of

    if specimen is None:
        if span is None or design is None:
            message = "the cross-section of the tested part is not known"
            raise InputError(Diagnostic(message, "give span and design, or a specimen"))
        specimen = specimen_of(as_actuator(design).subject(), part, span)
    return run(_record(record, columns, units, ("F_L", "w")), specimen)


@dataclass(frozen=True, slots=True, eq=False)
class Calibrated(Displayed):
    """A design with measured seal friction, and the effect on its requirements.

    Parameters
    ----------
    actuator : the design with the new values and their uncertainties
    calibration : the parameters found from the record
    redesign : how the measured friction changes the requirements, in the tested design and in the
        optimum
    """

    actuator: Actuator
    calibration: Calibration
    redesign: Redesign

    @property
    def in_short(self) -> tuple[str, str]:
        """The record, and the number of values found from it."""
        record = self.calibration.identification.record.name
        count = len(self.calibration.learned)
        return self.actuator.design.name, f"{count} values from {record}"

    def to_dict(self) -> dict[str, Any]:
        """As plain data for JSON, SI."""
        calibration = self.calibration
        return {
            "record": calibration.identification.record.name,
            "name": self.actuator.design.name,
            "learned": {value.name: value.to_dict() for value in calibration.learned},
            "left": dict(calibration.left),
            "coulomb": {"measured": calibration.coulomb, "stated": calibration.stated},
            "doubts": list(calibration.doubts),
            **self.redesign.to_dict(),
        }

    def page(self) -> Page:
        """The page of the calibration: fitted parameters, and their effect on the design."""
        from ..pages.calibration import page
        from ..studies.bench import bench

        return page(self.calibration, self.redesign, bench(self.actuator.subject()))


@guarded
def calibrate(
    record: Identification | Record | str | Path,
    *,
    design: Actuator | Design | Result | str | Path,
    columns: Mapping[str, str] | None = None,
    units: Units = None,
    search: bool = True,
    seed: int = 0,
    **settings: Any,
) -> Calibrated:
    """Set the seal friction of a design from its test record.

    Determines coefficients of friction, breakaway ratio, Stribeck speed and viscous friction of the
    seals. Their uncertainties are written under ``measured``. Requirements and optimum are compared
    before and after.

    Parameters
    ----------
    record : the record as read or identified, or the path of its file
    design : the actuator as tested
    columns, units, settings : as for `identify`, for a record that is not identified yet
    search : whether to optimise with the old and the new values
    seed : seed of the searches and the resampling

    Raises
    ------
    InputError
        as for `identify`; the record has no steady sliding; the design computes friction from an
        oil film; or the record was identified with another actuator
    """
    from ..identification import Identification, calibration as learn
    from ..identification.calibration import refuse_films
    from ..optimisation.redesign import redesign

    before = as_actuator(design)
    refuse_films(before.design)
    if isinstance(record, Identification):
        _require_use(record, before.design, {"columns": columns, "units": units}, settings)
        identified = record
    else:
        identified = identify(
            record, design=before, columns=columns, units=units, seed=seed, **settings
        )
    calibration = learn(identified)
    after, doubts = _with_values(before, calibration)
    calibration = replace(calibration, doubts=(*calibration.doubts, *doubts))
    groups = [value.bounds() for value in calibration.learned]
    changes = redesign(before.subject(), after.subject(), groups, seed=seed, search=search)
    return Calibrated(after, calibration, changes)


def _with_values(before: Actuator, calibration: Calibration) -> tuple[Actuator, list[str]]:
    """The actuator with the measured values, which are then fixed (no variables); and warnings."""
    design, values = before.design, calibration.values()
    variables = {path: x for path, x in design.variables.items() if path not in values}
    choices = {path: x for path, x in design.choices.items() if path not in values}
    update = {"variables": variables, "choices": choices, "measured": {}}
    base = Actuator(design.model_copy(update=update), before.source, before.plugins)
    measured = {**design.measured, **calibration.measured()}
    after = base.changed(values).design.model_copy(update={"measured": measured})
    doubts = []
    fixed = [path for path in values if path in design.variables or path in design.choices]
    if fixed:
        doubts.append(
            f"these are no longer variables, but fixed at the measured value: {', '.join(fixed)}"
        )
    seal_choices = [
        path
        for path in choices
        if path.startswith("seals.") and path.endswith((".compound", ".type"))
    ]
    if seal_choices:
        doubts.append(
            "the friction was measured with the tested seals, but is also used for the "
            f"other seals that the choices allow: {', '.join(seal_choices)}"
        )
    return Actuator(after, before.source, before.plugins), doubts


def _require_use(
    identified: Identification,
    design: Design,
    reading: Mapping[str, object],
    settings: Mapping[str, Any],
) -> None:
    """Reject settings without effect on an identified record, or a design other than its own."""
    unused = [*(name for name, argument in reading.items() if argument), *settings]
    if unused:
        message = f"{', '.join(unused)}: without effect, as the record is already identified"
        raise InputError(Diagnostic(message, "pass them to identify"))
    own, other = (
        stated.model_copy(update=dict.fromkeys(_NOT_TESTED))
        for stated in (design, identified.bench.design)
    )
    if own != other:
        message = "the record was identified with another design"
        raise InputError(Diagnostic(message, "identify it with this design"))


@guarded
def write_identification(
    identification: Identification, **paper: Unpack[ReportArguments]
) -> list[ReportFile]:
    """Write the page of an identification (PDF and PNG); parameters as for `report`."""
    from ..pages.identification import page, samples_hash
    from ..rendering import paper as writer

    record = identification.record
    origin, place = page_of(
        identification.bench.design, "_identification", beside=record.file_name, **paper
    )
    run: dict[str, Any] = {"record": record.file_name, "record_sha256": samples_hash(record)}
    return writer.write(page(identification), origin, **place, **run)


@guarded
def write_series(identification: Identification, path: str | Path) -> ReportFile:
    """Write friction, stiffness and bore growth over time as CSV."""
    from ..pages.identification import series
    from ..rendering.series import write_csv

    return write_csv(series(identification), Path(path))


@guarded
def write_calibration(calibrated: Calibrated, **paper: Unpack[ReportArguments]) -> list[ReportFile]:
    """Write the page of a calibration (PDF and PNG) and attach the new design.

    Parameters as for `report`; the attached design contains the calibrated values.
    """
    from ..design.writer import to_yaml
    from ..pages.identification import samples_hash
    from ..rendering import paper as writer

    actuator = paper["actuator"] = calibrated.actuator
    record = calibrated.calibration.identification.record
    origin, place = page_of(actuator.design, "_calibration", beside=record.file_name, **paper)
    origin = replace(origin, source_text=to_yaml(actuator.design, actuator.source))
    run: dict[str, Any] = {"record": record.file_name, "record_sha256": samples_hash(record)}
    return writer.write(calibrated.page(), origin, **place, **run)
