"""One page about several Simulations side by side: PDF and PNG."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from ..rendering import paper as writer
from ..rendering.blocks import Block, notes, soft
from ..rendering.origin import Origin
from . import simulation_comparison as compare
from .simulation_comparison import Comparison
from .simulation_comparison_figures import LEAST, MOST, comparison_figure
from .simulation_document import headed, room
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
    """Write the page as ``STEM.pdf`` and ``STEM.png``; parameters as `comparison_document`.

    Parameters
    ----------
    folder, stem : where to
    """
    data = comparison_document(comparison, origin, measured=measured, static=static, extra=extra)
    return writer.write_page(data, origin, title=comparison.title, folder=folder, stem=stem)


def comparison_document(
    comparison: Comparison,
    origin: Origin,
    *,
    measured: Measured | None = None,
    static: Static | None = None,
    extra: Sequence[Block] = (),
) -> dict[str, Any]:
    """The page as plain data for the renderers.

    Parameters
    ----------
    comparison : the runs, by `simulation_comparison.comparison`
    origin : of the page
    measured : time [s] and values (SI) by the name of a signal, drawn under the runs
    static : positions [m] and static stiffness [N/m], drawn beside the dynamic ones
    extra : blocks below all others
    """
    said = [tied(one) for one in compare.trust(comparison)]
    below = [compare.run_table(comparison), notes("What this rests on", said)]
    what = tied(compare.what(comparison))
    left = room(comparison.title, what, [*below, *extra])
    if left < LEAST:  # what the caller adds goes on to the next sheet
        left = room(comparison.title, what, below)
    height = min(max(left, LEAST), MOST)
    drawing = comparison_figure(comparison, height, measured=measured, static=static)
    designs = dict.fromkeys(found.plant.design.name for _, found in comparison.runs)
    return headed(comparison.title, ", ".join(designs), origin, KIND) | {
        "verdict": compare.verdict(comparison),
        "sentence": soft(what),
        "tiles": compare.tiles(comparison),
        "section": drawing.data(),
        "scale": "",
        "items": [],
        "blocks": [*below, *extra],
    }
