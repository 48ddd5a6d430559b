"""One page about several Simulations side by side: PDF and PNG."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from ..rendering import paper as writer
from ..rendering.blocks import Block, Notes, Page
from ..rendering.origin import Origin
from . import simulation_comparison as compare
from .simulation_comparison import Comparison
from .simulation_comparison_figures import LEAST, MOST, comparison_figure
from .simulation_series import Measured
from .simulation_stiffness import Static
from .simulation_words import tied

KIND = "Simulations compared"


def write_comparison_sheet(
    comparison: Comparison,
    origin: Origin,
    *,
    folder: Path,
    stem: str,
    measured: Measured | None = None,
    static: Static | None = None,
    extra: Sequence[Block] = (),
) -> list[writer.ReportFile]:
    """Write the page as ``STEM.pdf`` and ``STEM.png``; parameters as `comparison_page`.

    Parameters
    ----------
    folder, stem : where to
    """
    page = comparison_page(comparison, measured=measured, static=static, extra=extra)
    return writer.write(page, origin, folder=folder, stem=stem)


def comparison_page(
    comparison: Comparison,
    *,
    measured: Measured | None = None,
    static: Static | None = None,
    extra: Sequence[Block] = (),
) -> Page:
    """The page of several simulations.

    Parameters
    ----------
    comparison : the runs, by `simulation_comparison.comparison`
    measured : time [s] and values (SI) by the name of a signal, drawn under the runs
    static : positions [m] and static stiffness [N/m], drawn beside the dynamic ones
    extra : blocks below all others
    """
    said = [tied(one) for one in compare.trust(comparison)]
    below = [compare.run_table(comparison), Notes("What this rests on", said)]
    designs = dict.fromkeys(found.plant.design.name for _, found in comparison.runs)
    return Page(
        name=comparison.title,
        kind=KIND,
        design=", ".join(designs),
        verdict=compare.verdict(comparison),
        sentence=tied(compare.what(comparison)),
        tiles=compare.tiles(comparison),
        hero=lambda room: comparison_figure(
            comparison, min(room, MOST), measured=measured, static=static
        ),
        least=LEAST,
        blocks=[*below, *extra],
    )
