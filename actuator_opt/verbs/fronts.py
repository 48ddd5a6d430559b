"""Pareto fronts: found, and written down."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from ..design import Design
from ..errors import InputError
from .actuator import Actuator, Plugins, as_actuator, located, place, unanswered
from .reports import file_name, origin

if TYPE_CHECKING:
    from ..optimisation.pareto_result import ParetoFront
    from ..reporting import ReportFile


def pareto(
    design: Actuator | Design | str | Path,
    objectives: Sequence[str],
    *,
    n: int = 50,
    seed: int = 0,
    checks: int = 3,
    plugins: Plugins = (),
) -> ParetoFront:
    """Evenly spread designs of the Pareto front, with the knee.

    Parameters
    ----------
    design : as `optimise`
    objectives : two to four of ``METRIC:min`` or ``METRIC:max``
    n : designs asked for
    seed : same seed, same front
    checks : full searches at places in between, for what is merely local
    plugins : the user's metrics and constraints
    """
    from ..optimisation.pareto import pareto as run

    actuator = as_actuator(design, plugins)
    subject = actuator.subject()
    faults = unanswered(actuator, subject)
    if faults:
        raise InputError(faults)
    with located(actuator):
        return run(subject, objectives, count=n, seed=seed, checks=checks, fault=place(actuator))


def write_front_csv(found: ParetoFront, path: str | Path) -> ReportFile:
    """Write the designs of a front as CSV, units in the header."""
    from ..reporting.pareto_rows import write_csv

    return write_csv(found, Path(path))


def write_front(
    found: ParetoFront,
    *,
    folder: str | Path = "reports",
    actuator: Actuator | None = None,
    command: str = "",
    date: str | None = None,
) -> list[ReportFile]:
    """Write the page of a front (PDF and PNG) and its figure (PNG and SVG); as `report`."""
    from ..reporting.pareto_document import write_front_sheet

    source = None if actuator is None else actuator.source
    stem = Path(file_name(found.subject, source)).stem
    return write_front_sheet(
        found,
        origin(found.subject, source, command=command, date=date),
        folder=Path(folder),
        stem=f"{stem}_pareto",
    )
