"""Run uncertainty studies and write their reports."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Unpack

from ..base.errors import Diagnostic, UsageError
from ..design import Design
from .actuator import Actuator, Plugins, answered, located
from .reports import Paper, page_of

if TYPE_CHECKING:
    from ..pages import ReportFile
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
    rows : rows for the indices, (inputs + 2) evaluations each; 0 for no indices
    metrics : evaluated beside the margins of all limits; default: those of the objective
    plugins : the user's own metrics and constraints

    Raises
    ------
    InputError
        a distribution that does not fit its value, or of a number that no model reads
    """
    from ..uncertainties import uncertainty as run

    if not LEAST <= count <= MOST:
        message = f"{count} draws: need {LEAST} to {MOST}"
        raise UsageError(Diagnostic(message, "10000 bounds a yield of 99 % within 0.2 %"))
    actuator, subject = answered(design, plugins)
    with located(actuator):
        return run(
            subject, count=count, seed=seed, quasi_random=quasi_random, rows=rows, metrics=metrics
        )


def write_uncertainty(study: Uncertainty, **paper: Unpack[Paper]) -> list[ReportFile]:
    """Write the page of an uncertainty study as PDF and PNG; parameters as `report`.

    Raises
    ------
    UsageError : no `actuator`, as the study does not keep its design
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
