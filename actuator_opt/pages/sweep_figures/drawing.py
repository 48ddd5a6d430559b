"""The figures of a sweep as files."""

from __future__ import annotations

from collections.abc import Sequence
from importlib import import_module
from pathlib import Path

from ...base.bounds import SWEEP_FIGURES
from ...base.errors import Diagnostic, UsageError, remedy, shown
from ...base.files import write_all
from ...rendering.image import images
from ...rendering.ink import Ink
from ...sweeps import Swept
from ...sweeps.chunk import Study
from .shared import ORIGINS, SweepFigure, SweepFigureData

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
    own = [limit.metric for limit in study.binding if limit.origin in ORIGINS]
    return tuple(dict.fromkeys([*goal, *own]))[:USUAL]


def watched(study: Study, kinds: Sequence[str], show: Sequence[str]) -> tuple[str, ...]:
    """Refuse figures that cannot be; the metrics whose Pareto lines they need.

    Raises
    ------
    UsageError
        no such figure or metric, or a sweep that does not fit it
    """
    figures = [figure(kind) for kind in dict.fromkeys(kinds)]
    metrics = chosen(study, show)
    if not study.full and any(own.every for own in figures):
        every = " and ".join(kind for kind in SWEEP_FIGURES if figure(kind).every)
        message = f"--reduce keeps the best alone, {every} need every design"
        raise UsageError(Diagnostic(message, "leave out --reduce"))
    for own in figures:
        own.check(study, metrics)
    return metrics if any(own.lines for own in figures) else ()


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
    drawn, metrics = SweepFigureData(swept), chosen(swept.study, show)
    inks: dict[str, Ink] = {}
    for kind in dict.fromkeys(kinds):
        pictures = figure(kind).draw(drawn, metrics, bool(show))
        if doubled := inks.keys() & pictures.keys():
            raise ValueError(f"figure {kind}: another figure draws {', '.join(doubled)} too")
        inks |= pictures
    return inks


def write_figures(
    swept: Swept, kinds: Sequence[str], show: Sequence[str], folder: Path, stem: str
) -> list[Path]:
    """Write STEM-sweep-FIGURE.png and .svg of every figure, whole or not at all."""
    contents: dict[str, bytes] = {}
    for name, ink in sweep_figures(swept, kinds, show).items():
        contents |= images(ink, f"{stem}-sweep-{name}")
    write_all(folder, contents)
    return [folder / name for name in contents]


def figure(kind: str) -> SweepFigure:
    """The figure of a word.

    Raises
    ------
    UsageError : no such figure
    """
    if kind not in SWEEP_FIGURES:
        advice = remedy(kind, SWEEP_FIGURES, 4)
        raise UsageError(Diagnostic(f"--figure {shown(kind)}: unknown", advice))
    module = import_module(f".{kind}", __package__)
    stated: SweepFigure = module.FIGURE
    return stated
