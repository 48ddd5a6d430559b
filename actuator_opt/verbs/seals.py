"""One seal looked at closely."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from ..design import Design
from .actuator import Actuator, as_actuator
from .reports import file_name, origin

if TYPE_CHECKING:
    from ..evaluation.rings import Place
    from ..evaluation.study.seal import SealStudy
    from ..reporting import ReportFile


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
    from ..evaluation.study.seal import study, with_elements
    from ..friction import film

    actuator = as_actuator(design)
    elements = getattr(actuator.design.seals, place).elements()
    asked = {f"seals.{place}.{tail}friction": film.LAW.name for tail in elements}
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
    from ..reporting.seal_document import write_map, write_sheet

    source = None if actuator is None else actuator.source
    stem = f"{Path(file_name(study.design, source)).stem}_{study.place}_seal"
    files = []
    if sheet:
        page = origin(study.design, source, command=command, date=date)
        files += write_sheet(study, page, folder=Path(folder), stem=stem)
    if study.map is not None:
        files.append(write_map(study.map, Path(folder) / f"{stem}_map.csv"))
    return files
