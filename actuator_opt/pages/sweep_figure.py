"""What a figure of a sweep states; one module each, listed in `bounds.SWEEP_FIGURES`."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from importlib import import_module

from ..base.bounds import SWEEP_FIGURES
from ..base.errors import Diagnostic, UsageError
from ..base.suggest import remedy, shown
from ..rendering.ink import Ink
from ..sweeps.chunk import Study
from .sweep_marks import SweepFigureData


@dataclass(frozen=True, slots=True)
class SweepFigure:
    """A figure of a sweep.

    Attributes
    ----------
    every : whether it needs every design, not the best alone
    lines : whether it draws Pareto lines of its metrics
    check : raises `UsageError` for a sweep or metrics that do not fit
    draw : pictures by the end of their file's name, from the sweep, the metrics, and whether
        these were asked for
    """

    every: bool
    lines: bool
    check: Callable[[Study, Sequence[str]], None]
    draw: Callable[[SweepFigureData, Sequence[str], bool], Mapping[str, Ink]]


def figure(kind: str) -> SweepFigure:
    """The figure of a word.

    Raises
    ------
    UsageError : no such figure
    """
    if kind not in SWEEP_FIGURES:
        advice = remedy(kind, SWEEP_FIGURES, 4)
        raise UsageError(Diagnostic(f"--figure {shown(kind)}: unknown", advice))
    module = import_module(f".{SWEEP_FIGURES[kind]}", __package__)
    found: SweepFigure = module.FIGURE
    return found


def fits(study: Study, metrics: Sequence[str]) -> None:
    """The check of a figure that fits every sweep."""
