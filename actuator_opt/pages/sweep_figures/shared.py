"""Common parts of sweep figures: quantities with units, limits in words, headings, files."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import cached_property
from importlib import import_module
from pathlib import Path

import numpy as np

from ...base.bounds import SWEEP_FIGURES
from ...base.dataclass import dataclass
from ...base.errors import Diagnostic, InputError, UsageError, remedy, shown
from ...base.files import write_all
from ...base.numeric import Array
from ...base.quantities import Quantity
from ...design.paths import quantity_of
from ...evaluation import prepare
from ...evaluation.limits import MetricLimit
from ...rendering.axes import fitted
from ...rendering.heights import wrap
from ...rendering.ink import GREY, PALE, Ink
from ...rendering.paper import images
from ...rendering.text import SENSES, limit_text, number, unit_text, with_unit
from ...sweeps import Best, Swept
from ...sweeps.chunk import Study

BETTER = ("#7fb0cf", "#3f7aa3", "#0b3c5d")
"""Colours of feasible designs by thirds of the objective; the best third is last and darkest."""
INFEASIBLE = PALE
ORIGINS = ("requirement", "case")
"""Origins of a limit that is stated in the design file."""


@dataclass(frozen=True)
class DrawnRows:
    """Designs to draw.

    For each design, `rows` (designs, columns) has its inputs and metrics, and `variants` the index
    of its combination of named values (such as materials). `every` is the sampling step: 1 if all
    designs are drawn.
    """

    variants: Array
    rows: Array
    every: int = 1


@dataclass(frozen=True)
class Track:
    """A quantity that every design has: either a number, or one of the `names`."""

    words: str
    quantity: Quantity | None = None
    names: tuple[str, ...] = ()

    @property
    def unit(self) -> str:
        """The display unit."""
        return "" if self.quantity is None else unit_text(self.quantity.unit)

    @property
    def label(self) -> str:
        """Label with the unit."""
        return f"{self.words}, {self.unit}" if self.unit else self.words

    def shown(self, values: Array) -> Array:
        """SI values converted to the display unit."""
        if self.quantity is None:
            return values
        displayed: Array = self.quantity.to_display(values)
        return displayed


class SweepFigureData:
    """Values and limits of a sweep for its figures."""

    def __init__(self, swept: Swept) -> None:
        self.swept, self.study = swept, swept.study

    @cached_property
    def limits(self) -> list[tuple[MetricLimit, float]]:
        """Required limits with their value (SI), without limits that the sweep varies."""
        study = self.study
        v = prepare(study.design, plugins=study.plugins).values({})
        varied = {axis.path for axis in study.plan.axes}
        return [
            (limit, float(np.max(limit.value(v))))
            for limit in study.binding
            if not {limit.path, limit.lever} & varied
        ]

    def limits_on(self, metric: str) -> list[tuple[str, float]]:
        """The strictest lower and the strictest upper limit on a metric: senses and values (SI)."""
        strictest: dict[str, float] = {}
        for limit, value in self.limits:
            if limit.metric == metric:
                pick = max if limit.sense == "min" else min
                strictest[limit.sense] = pick(value, strictest.get(limit.sense, value))
        return list(strictest.items())

    def limit_words(self, limit: MetricLimit) -> str:
        """A limit in words: ``"stiffness_min ≥ 10 kN/mm"``."""
        known = next((value for other, value in self.limits if other is limit), None)
        head = limit.name if limit.origin == "case" else limit.metric
        if known is None:
            return f"{head} {SENSES[limit.sense]} varied value"
        return f"{head} {limit_text(self.study.quantity(limit.metric), limit.sense, known)}"

    def axis(self, path: str) -> Track:
        """The `Track` of a varied input."""
        axis = next(axis for axis in self.study.plan.axes if axis.path == path)
        if axis.values is None:
            return Track(path, names=axis.texts)
        return Track(path, quantity_of(path, self.study.design))

    def metric(self, name: str) -> Track:
        """The `Track` of a metric."""
        return Track(name, self.study.quantity(name))

    def values(self, name: str, drawn: DrawnRows) -> Array:
        """Values of a varied input or of a metric, in the unit of its `Track`."""
        for axis in self.study.plan.named:
            if axis.path == name:
                texts = [self.study.plan.texts(int(variant))[name] for variant in drawn.variants]
                return np.array([axis.texts.index(text) for text in texts], dtype=float)
        of_axis = any(axis.path == name for axis in self.study.plan.axes)
        track = self.axis(name) if of_axis else self.metric(name)
        return track.shown(drawn.rows[:, self.study.place(name)])

    def objective(self, drawn: DrawnRows) -> Array:
        """The objective of designs, with opposite sign if it is maximised: less is better."""
        total = np.zeros(len(drawn.rows))
        for name, weight in self.study.goal.weights.items():
            total += weight / self.study.goal.scales[name] * drawn.rows[:, self.study.place(name)]
        return self.study.goal.sign * total

    @property
    def goal(self) -> Track:
        """The objective as a quantity, with its name and unit."""
        single = self.study.goal.single
        return Track("objective") if single is None else self.metric(single)

    def goals(self, drawn: DrawnRows) -> Array:
        """The objective of designs, in the unit of `goal`."""
        single = self.study.goal.single
        if single is not None:
            return self.values(single, drawn)
        return self.study.goal.sign * self.objective(drawn)

    def best(self, place: int = 0) -> DrawnRows:
        """One of the best designs.

        Raises
        ------
        InputError
            no design is feasible
        """
        best = self.bests()[place]
        variant = self.study.plan.points(best.number, 1).variant
        return DrawnRows(variant, np.array([best.row]))

    def bests(self) -> list[Best]:
        """The best designs; raises `InputError` if no design is feasible."""
        if not self.swept.best:
            message = f"no feasible design among {self.swept.requested} variants"
            raise InputError(
                Diagnostic(message, "widen the varied ranges, or draw a contour of a grid")
            )
        return self.swept.best

    def feasible(self, most: int) -> tuple[DrawnRows, list[str]]:
        """At most `most` feasible designs, the best last, and the fill colour of each."""
        kept = DrawnRows(*self.swept.sample.feasible.thinned(most))
        order = np.argsort(-self.objective(kept), kind="stable")
        fills = [BETTER[3 * k // max(len(order), 1)] for k in range(len(order))]
        return DrawnRows(kept.variants[order], kept.rows[order], kept.every), fills

    def others(self, most: int) -> DrawnRows:
        """At most `most` designs that miss a limit."""
        return DrawnRows(*self.swept.sample.others.thinned(most))

    def require(self, metric: str, *drawn: DrawnRows) -> None:
        """Raise `InputError` if no design has a value for a metric."""
        if not any(np.isfinite(self.values(metric, x)).any() for x in drawn if len(x.rows)):
            message = f"--show {metric}: it has no value for any design of this sweep"
            raise InputError(Diagnostic(message, "show another metric"))

    def counts(self, *drawn: tuple[str, int]) -> str:
        """Words on the number of designs, and on how many of them are drawn."""
        swept = self.swept
        words = f"{_many(swept.requested)} variants, "
        if swept.feasible is None:
            full = swept.computed - swept.screened
            words += f"{_many(swept.screened)} ruled out early, {_many(full)} evaluated in full"
        else:
            words += f"{_many(swept.feasible)} feasible"
        if swept.failed:
            words += f", {_many(swept.failed)} failed (not drawn)"
        thinned = [f"every {_nth(step)} {group}" for group, step in drawn if step > 1]
        return words + (f"; drawn: only {' and '.join(thinned)} design" if thinned else "")


def _many(count: int) -> str:
    return number(float(count), max(len(str(count)), 1))


def _nth(step: int) -> str:
    ending = {1: "st", 2: "nd", 3: "rd"}.get(step % 10, "th")
    return f"{step}{'th' if step % 100 in (11, 12, 13) else ending}"


def heading(ink: Ink, drawn: SweepFigureData, words: str, notes: str) -> float:
    """Draw the title with the design's name, and the notes; return the height they take up."""
    room = ink.width - 4.0
    title = fitted(f"{drawn.study.design.name}: {words}", room * 0.88, 9.0)
    ink.text(2.0, 3.0, title, size=9.0, bold=True)
    lines = wrap(notes, room, 6.5)
    for k, line in enumerate(lines):
        ink.text(2.0, 7.6 + 3.2 * k, line, color=GREY)
    return 7.6 + 3.2 * len(lines)


def value_words(track: Track, value: float) -> str:
    """A value as shown, with its unit."""
    if track.names:
        return track.names[int(value)]
    return with_unit(number(value), track.unit)


def two_lines(words: str, room: float, size: float) -> Sequence[str]:
    """A PATH in at most two lines, cut at its last dot where it is too wide."""
    first = fitted(words, room, size)
    if first == words or "." not in words:
        return [first]
    head, _, tail = words.rpartition(".")
    return [fitted(head + ".", room, size), fitted(tail, room, size)]


@dataclass(frozen=True, slots=True)
class SweepFigure:
    """A figure of a sweep.

    Attributes
    ----------
    every : whether the figure needs every design, and not only the best
    lines : whether the figure draws Pareto lines of its metrics
    check : raises `UsageError` if sweep or metrics do not suit the figure
    draw : function of the sweep, the metrics, and whether the user named these; returns pictures by
        the ending of their file names
    """

    every: bool
    lines: bool
    check: Callable[[Study, Sequence[str]], None]
    draw: Callable[[SweepFigureData, Sequence[str], bool], Mapping[str, Ink]]


def fits(study: Study, metrics: Sequence[str]) -> None:
    """The check of a figure that suits every sweep."""


USUAL = 5
"""Largest number of metrics shown if the user chooses none."""


def chosen(study: Study, show: Sequence[str]) -> tuple[str, ...]:
    """The metrics to show: as requested, or else those of objective and requirements.

    A sweep may have kept only some of them.

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
    kept = dict.fromkeys(name for name in (*goal, *own) if name in study.metrics)
    return tuple(kept)[:USUAL]


def watched(study: Study, kinds: Sequence[str], show: Sequence[str]) -> tuple[str, ...]:
    """Check that figures can be drawn; return the metrics for which they need Pareto lines.

    Raises
    ------
    UsageError
        no such figure or metric, or a sweep that does not fit it
    """
    figures = [figure(kind) for kind in dict.fromkeys(kinds)]
    metrics = chosen(study, show)
    if not study.full and any(own.every for own in figures):
        every = " and ".join(kind for kind in SWEEP_FIGURES if figure(kind).every)
        message = f"--reduce keeps only the best designs, but {every} need every design"
        raise UsageError(Diagnostic(message, "leave out --reduce"))
    for own in figures:
        own.check(study, metrics)
    return metrics if any(own.lines for own in figures) else ()


def sweep_figures(swept: Swept, kinds: Sequence[str], show: Sequence[str] = ()) -> dict[str, Ink]:
    """The figures of a sweep, by the ending of their file names.

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
            raise ValueError(
                f"figure {kind}: another figure already uses the file name ending "
                f"{', '.join(doubled)}"
            )
        inks |= pictures
    return inks


def write_figures(
    swept: Swept, kinds: Sequence[str], show: Sequence[str], folder: Path, stem: str
) -> list[Path]:
    """Write STEM-sweep-FIGURE.png and .svg of every figure, completely or not at all."""
    contents: dict[str, bytes] = {}
    for name, ink in sweep_figures(swept, kinds, show).items():
        contents |= images(ink, f"{stem}-sweep-{name}")
    write_all(folder, contents)
    return [folder / name for name in contents]


def figure(kind: str) -> SweepFigure:
    """The figure with a given name.

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
