"""Run uncertainty studies and detailed studies of a seal, and write their reports."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Unpack

from ..base.errors import Diagnostic, UsageError
from ..design import Design
from .actuator import Actuator, Plugins, as_actuator, checked_design, located
from .reports import ReportArguments, page_of

if TYPE_CHECKING:
    from ..evaluation.rings import Place
    from ..pages import ReportFile
    from ..studies.seal import SealStudy
    from ..uncertainties import Uncertainty

LEAST, MOST = 20, 10_000_000
"""Minimum and maximum number of draws."""


def uncertainty(
    design: Actuator | Design | str | Path,
    *,
    count: int = 10_000,
    seed: int = 0,
    quasi_random: bool = False,
    rows: int = 1024,
    metrics: Sequence[str] = (),
    plugins: Plugins = (),
) -> Uncertainty:
    """Return yield, sensitivity indices and tornado of a design with uncertain inputs.

    Uncertain inputs come from the design (``uncertainty:``, ``measured:``), the libraries, ISO 286
    and common practice.

    Parameters
    ----------
    design : the design
    count : draws for the yield
    seed : the same seed gives the same result
    quasi_random : draw scrambled Sobol points, with 16 randomisations, instead of independent ones
    rows : rows for the indices, (inputs + 2) evaluations each; 0: no indices
    metrics : analysed beside the margins of all limits; default: the metrics of the objective
    plugins : the user's own metrics and constraints

    Raises
    ------
    InputError
        a distribution that does not fit its value, or belongs to a number that no model reads
    """
    from ..uncertainties import uncertainty as run

    if not LEAST <= count <= MOST:
        message = f"{count} draws: {LEAST} to {MOST} are needed"
        raise UsageError(Diagnostic(message, "10000 draws give a yield of 99 % within 0.2 %"))
    actuator, subject = checked_design(design, plugins)
    with located(actuator):
        return run(
            subject, count=count, seed=seed, quasi_random=quasi_random, rows=rows, metrics=metrics
        )


def write_uncertainty(study: Uncertainty, **paper: Unpack[ReportArguments]) -> list[ReportFile]:
    """Write the page of an uncertainty study as PDF and PNG; parameters as `report`.

    Raises
    ------
    UsageError : no `actuator`, as the study does not contain its design
    """
    from ..pages.uncertainty import page
    from ..rendering import paper as printed

    actuator = paper.get("actuator")
    if actuator is None:
        message = "the page of an uncertainty study needs the design"
        raise UsageError(Diagnostic(message, "give actuator=..."))
    origin, place = page_of(actuator.design, "_uncertainty", **paper)
    return printed.write(page(study), origin, **place)


def write_draws(study: Uncertainty, path: str | Path) -> ReportFile:
    """Write the stored draws as CSV: inputs, margins of all limits, whether all are met."""
    from ..pages.uncertainty import series
    from ..rendering.series import write_csv

    return write_csv(series(study), Path(path))


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

    The film is solved even if the design uses a coefficient of friction.

    Parameters
    ----------
    design : as `evaluate`
    place : "piston" or "rod"
    speed, pressure : of the counterface [m/s], sealed gauge [Pa]; default: from the moving load
        case with the highest pressure
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
    changes = {f"seals.{place}.{tail}friction": film.LAW.name for tail in elements}
    subject = actuator.changed(changes).subject()
    subject, profiles = with_elements(subject, place) if finite_elements else (subject, ())
    return study(
        subject,
        place,
        speed=speed,
        pressure=pressure,
        curves=curves,
        mapped=mapped,
        elements=profiles,
    )


def with_contact(actuator: Actuator, study: SealStudy) -> Actuator:
    """The actuator as read, with the contact profiles of its seal study."""
    seals = actuator.design.seals
    contact = getattr(study.design.seals, study.place).contact
    seal = getattr(seals, study.place).model_copy(update={"contact": contact})
    own = seals.model_copy(update={study.place: seal})
    design = actuator.design.model_copy(update={"seals": own})
    return Actuator(design, actuator.source, actuator.plugins)


def write_seal(
    study: SealStudy, *, sheet: bool = True, **paper: Unpack[ReportArguments]
) -> list[ReportFile]:
    """Write the sheet of a seal (PDF and PNG), and its map, if any, as CSV.

    Parameters
    ----------
    study : of `seal`
    sheet : whether to write the sheet, or only the map
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
