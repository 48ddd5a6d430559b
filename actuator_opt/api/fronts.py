"""Pareto fronts: the search, and its files."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Unpack

from ..design import Design
from .actuator import Actuator, Plugins, answered, located, place
from .reports import Paper, page_of, report_files

if TYPE_CHECKING:
    from ..optimisation.pareto import ParetoFront
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


def write_front_csv(front: ParetoFront, path: str | Path) -> ReportFile:
    """Write the designs of a front as CSV, units in the header."""
    from ..pages.pareto import series
    from ..rendering.series import write_csv

    return write_csv(series(front), Path(path))


def write_front(front: ParetoFront, **paper: Unpack[Paper]) -> list[ReportFile]:
    """Write the page of a front (PDF and PNG) and its figure (PNG and SVG).

    A front without designs writes nothing. Parameters as `report`.
    """
    from ..pages.pareto import front_figure, front_outcome, page
    from ..rendering import paper as printed
    from ..rendering.image import write_ink

    if not front.points:
        return []
    origin, place = page_of(front.subject, "_pareto", **paper)
    files = printed.write(page(front), origin, result=front_outcome(front), **place)
    pictures = write_ink(front_figure(front), place["folder"], f"{place['stem']}_figure")
    return files + report_files(pictures)
