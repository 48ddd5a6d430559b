"""The figures of a sweep as files: parallel axes, scatter matrix, contours, U-curves."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from ..errors import Diagnostic, UsageError
from ..suggest import remedy, shown
from ..variants import Swept
from ..variants.chunk import Study
from ..variants.field import field, require_grid
from . import writer
from .image import images
from .ink import Ink
from .sweep_contour import contour_figure
from .sweep_marks import Drawn
from .sweep_parallel import parallel_figure
from .sweep_scatter import require_some, scatter_figure
from .sweep_ucurves import ucurves_figure

KINDS = ("parallel", "scatter", "contour", "ucurves")
USUAL = 5
"""Metrics shown where none is chosen, at most."""


def chosen(study: Study, show: Sequence[str]) -> tuple[str, ...]:
    """The metrics to show: those asked for, else the objective's and the requirements'.

    Raises
    ------
    UsageError
        no such metric
    """
    for name in show:
        if name not in study.metrics:
            message = f"--show {shown(name)}: no metric of this design"
            raise UsageError(Diagnostic(message, remedy(name, study.metrics)))
    if show:
        return tuple(dict.fromkeys(show))
    goal = [*study.goal.weights]
    own = [one.metric for one in study.binding if one.origin in ("requirement", "case")]
    return tuple(dict.fromkeys([*goal, *own]))[:USUAL]


def watched(study: Study, kinds: Sequence[str], show: Sequence[str]) -> tuple[str, ...]:
    """Refuse figures that cannot be; the metrics whose Pareto lines they need.

    Raises
    ------
    UsageError
        no such figure or metric, or a sweep that does not fit it
    """
    for kind in kinds:
        if kind not in KINDS:
            raise UsageError(Diagnostic(f"--figure {shown(kind)}: unknown", remedy(kind, KINDS, 4)))
    metrics = chosen(study, show)
    if not study.full and {"parallel", "scatter"} & set(kinds):
        message = "--reduce keeps the best alone, parallel and scatter need every design"
        raise UsageError(Diagnostic(message, "leave out --reduce"))
    if "contour" in kinds:
        require_grid(study.plan)
    if "scatter" not in kinds:
        return ()
    require_some(metrics)
    return metrics


def sweep_figures(swept: Swept, kinds: Sequence[str], show: Sequence[str] = ()) -> dict[str, Ink]:
    """The figures of a sweep by the end of their file's name.

    Raises
    ------
    UsageError
        no such figure or metric, or a sweep that does not fit it
    InputError
        no feasible design, or a metric without values
    """
    watched(swept.study, kinds, show)
    drawn, metrics, found = Drawn(swept), chosen(swept.study, show), {}
    for kind in dict.fromkeys(kinds):
        if kind == "parallel":
            found[kind] = parallel_figure(drawn, metrics)
        elif kind == "scatter":
            found[kind] = scatter_figure(drawn, metrics)
        elif kind == "ucurves":
            found[kind] = ucurves_figure(drawn)
        else:
            grid = field(swept.study)
            lines = list(grid.boundaries())
            for name in metrics if show else metrics[:1]:
                found[f"contour-{name}"] = contour_figure(drawn, grid, lines, name)
    return found


def write_figures(
    swept: Swept, kinds: Sequence[str], show: Sequence[str], folder: Path, stem: str
) -> list[Path]:
    """Write STEM-sweep-FIGURE.png and .svg of every figure, whole or not at all."""
    contents: dict[str, bytes] = {}
    for name, ink in sweep_figures(swept, kinds, show).items():
        contents |= images(ink, f"{stem}-sweep-{name}")
    writer.write_all(folder, contents)
    return [folder / name for name in contents]
