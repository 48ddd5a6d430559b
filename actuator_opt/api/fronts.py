"""Compute Pareto fronts and write their reports."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Unpack

from ..design import Design
from .actuator import Actuator, Plugins, answered, located, place
from .reports import Paper, page_of

if TYPE_CHECKING:
    from ..optimisation.pareto_result import ParetoFront
    from ..pages import ReportFile


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
    n : designs requested
    seed : same seed, same front
    checks : independent searches between designs, which reveal merely local ones
    plugins : the user's metrics and constraints
    """
    from ..optimisation.pareto import pareto as run

    actuator, subject = answered(design, plugins)
    with located(actuator):
        return run(subject, objectives, count=n, seed=seed, checks=checks, fault=place(actuator))


def write_front_csv(found: ParetoFront, path: str | Path) -> ReportFile:
    """Write the designs of a front as CSV, units in the header."""
    from ..pages.pareto_rows import write_csv

    return write_csv(found, Path(path))


def write_front(front: ParetoFront, **paper: Unpack[Paper]) -> list[ReportFile]:
    """Write the page of a front (PDF and PNG) and its figure (PNG and SVG).

    Writes nothing if there is no design. Parameters as `report`.
    """
    from ..pages.pareto_document import write_front_sheet

    if not front.points:
        return []
    origin, place = page_of(front.subject, "_pareto", **paper)
    return write_front_sheet(front, origin, **place)
