"""Runs uncertainty studies, and detailed studies of a seal; writes their reports."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Unpack

from ..base.arguments import guarded
from ..base.errors import Diagnostic, UsageError
from ..design import Design
from ..evaluation.rings import Place
from .actuator import Actuator, Plugins, Result, as_actuator, checked_design, located, workers_for
from .reports import ReportArguments, page_of

if TYPE_CHECKING:
    from ..pages import ReportFile
    from ..studies.seal import SealStudy
    from ..uncertainties import Uncertainty

LEAST, MOST = 20, 10_000_000
"""Minimum and maximum number of random draws in an uncertainty study."""


@guarded
def uncertainty(
    design: Actuator | Design | Result | str | Path,
    *,
    count: int = 10_000,
    seed: int = 0,
    quasi_random: bool = False,
    rows: int = 1024,
    metrics: Sequence[str] = (),
    plugins: Plugins = (),
    scheduler: str | None = None,
) -> Uncertainty:
    """Compute yield, sensitivity indices and tornado chart of a design with uncertain inputs.

    The yield is the probability that an actuator built to the design meets all limits.

    The distributions of the inputs come from the design (``uncertainty:``, ``measured:``), the
    material libraries, ISO 286 and common practice.

    Parameters
    ----------
    design : the design
    count : number of draws for the yield
    seed : seed of the draws; the same seed gives the same result
    quasi_random : whether to draw scrambled Sobol points, with 16 randomisations, instead of
        independent points
    rows : size of the base sample for the sensitivity indices, each row of which takes (inputs + 2)
        evaluations; 0 to omit the indices
    metrics : metrics to analyse besides the margins of all limits; default: those of the objective
    plugins : the user's own metrics and constraints
    scheduler : address of a Dask scheduler, used instead of this process for the draws and the
        indices (extra `cluster`)

    Raises
    ------
    UsageError
        the number of draws is not permitted, or no cluster answers
    InputError
        a distribution does not fit its value, or belongs to a number that no model reads
    """
    from ..uncertainties import uncertainty as run

    if not LEAST <= count <= MOST:
        message = f"{count} draws: {LEAST} to {MOST} are permitted"
        remedy = "10000 draws suffice to estimate a yield of 99 % within 0.2 %"
        raise UsageError(Diagnostic(message, remedy))
    actuator, subject = checked_design(design, plugins)
    with located(actuator), workers_for(actuator, scheduler) as cluster:
        return run(
            subject,
            count=count,
            seed=seed,
            quasi_random=quasi_random,
            rows=rows,
            metrics=metrics,
            cluster=cluster,
        )


@guarded
def write_uncertainty(study: Uncertainty, **paper: Unpack[ReportArguments]) -> list[ReportFile]:
    """Write the page of an uncertainty study as PDF and PNG; parameters as for `report`.

    Raises
    ------
    UsageError : `actuator` is missing; it is needed because a study does not contain its design
    """
    from ..pages.uncertainty import page
    from ..rendering import paper as printed

    actuator = paper.get("actuator")
    if actuator is None:
        message = "the page of an uncertainty study needs the design"
        raise UsageError(Diagnostic(message, "give actuator=..."))
    origin, place = page_of(actuator.design, "_uncertainty", **paper)
    return printed.write(page(study), origin, **place)


@guarded
def write_draws(study: Uncertainty, path: str | Path) -> ReportFile:
    """Write the stored draws as CSV: inputs, margins of all limits, and whether all are met."""
    from ..pages.uncertainty import series
    from ..rendering.series import write_csv

    return write_csv(series(study), Path(path))


@guarded
def seal(
    design: Actuator | Design | Result | str | Path,
    *,
    place: Place,
    speed: float | None = None,
    pressure: float | None = None,
    curves: bool = False,
    mapped: bool = False,
    finite_elements: bool = False,
) -> SealStudy:
    """Study the seals of piston or rod: contact, oil film, friction, leakage and damping.

    The film is solved even if the design states a coefficient of friction instead.

    Parameters
    ----------
    design : as for `evaluate`
    place : "piston" or "rod"
    speed, pressure : speed of the counterface [m/s] and sealed gauge pressure [Pa]; default: those
        of the moving load case with the highest pressure
    curves : whether to compute curves of friction versus speed at three pressures
    mapped : whether to compute a map of the results over speed and pressure
    finite_elements : whether to compute the contact profiles of O-rings and step rings (extra
        ``fem``); the study's design then contains these profiles

    Raises
    ------
    InputError
        the speed is not positive, or the pressure exceeds those of the stated contact profiles
    ActuatorError
        this seal has no finite-element model, or the model finds no equilibrium
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
    """The actuator as read, with the contact profiles that its seal study computed."""
    seals = actuator.design.seals
    contact = getattr(study.design.seals, study.place).contact
    seal = getattr(seals, study.place).model_copy(update={"contact": contact})
    own = seals.model_copy(update={study.place: seal})
    design = actuator.design.model_copy(update={"seals": own})
    return Actuator(design, actuator.source, actuator.plugins)


@guarded
def write_seal(
    study: SealStudy, *, sheet: bool = True, **paper: Unpack[ReportArguments]
) -> list[ReportFile]:
    """Write the page of a seal study (PDF and PNG) and its map, if there is one, as CSV.

    Parameters
    ----------
    study : result of `seal`
    sheet : whether to write the page; if False, only the map is written
    paper : as for `report`
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
