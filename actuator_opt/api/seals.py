"""Detailed study of a seal."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Unpack

from ..design import Design
from .actuator import Actuator, as_actuator
from .reports import Paper, page_of

if TYPE_CHECKING:
    from ..evaluation.rings import Place
    from ..pages import ReportFile
    from ..studies.seal import SealStudy


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

    The film is solved whether the design uses it or a coefficient of friction.

    Parameters
    ----------
    design : as `evaluate`
    place : "piston" or "rod"
    speed, pressure : of the counterface [m/s], sealed gauge [Pa]; default: those of the moving
        load case with the highest pressure
    curves : compute friction over speed at three pressures
    mapped : compute a map over speed and pressure
    finite_elements : compute the contact profiles of O-rings and step rings (extra ``fem``); the
        study's design states them

    Raises
    ------
    InputError
        no positive speed, or a pressure beyond the stated contact profiles
    ActuatorError
        no finite elements for this seal, or no equilibrium
    """
    from ..friction import film
    from ..studies.seal import study, with_elements

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
    """The actuator as read, with the contact profiles of its seal study."""
    seals = actuator.design.seals
    found = getattr(study.design.seals, study.place).contact
    seal = getattr(seals, study.place).model_copy(update={"contact": found})
    own = seals.model_copy(update={study.place: seal})
    design = actuator.design.model_copy(update={"seals": own})
    return Actuator(design, actuator.source, actuator.plugins)


def write_seal(study: SealStudy, *, sheet: bool = True, **paper: Unpack[Paper]) -> list[ReportFile]:
    """Write the sheet of a seal (PDF and PNG), and its map, if any, as CSV.

    Parameters
    ----------
    study : of `seal`
    sheet : whether to write the sheet, or the map alone
    paper : as `report`
    """
    from ..pages.seal import page, series
    from ..rendering.paper import write
    from ..rendering.series import write_csv

    origin, place = page_of(study.design, f"_{study.place}_seal", **paper)
    files = write(page(study), origin, **place) if sheet else []
    if study.map is not None:
        folder: Path = place["folder"]
        folder.mkdir(parents=True, exist_ok=True)
        files.append(write_csv(series(study.map), folder / f"{place['stem']}_map.csv"))
    return files
