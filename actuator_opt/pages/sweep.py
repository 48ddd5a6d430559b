"""The page of a sweep: counts, best designs, reasons of failures; and the columns of its files."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ..base.errors import InputError
from ..base.numeric import Array
from ..base.quantities import Quantity
from ..base.tables import encoded
from ..design.paths import quantity_of
from ..evaluation import prepare
from ..evaluation.build import spec_hash
from ..evaluation.result import NO_RESERVE
from ..rendering import text
from ..rendering.blocks import Block, Column, Notes, Page, Row, Table, Tile, Verdict, tile
from ..rendering.ink import Ink
from ..rendering.series import Coded, FileColumn, Values, heading
from ..sweeps import Swept
from ..sweeps.chunk import Chunk, Study
from ..sweeps.plan import SweepAxis
from ..version import VERSION
from .sweep_figures.parallel import parallel_figure
from .sweep_figures.shared import SweepFigureData, chosen

FAILURES = 3
"""Largest number of reasons for failed designs on the page."""
AXES = 7
"""Largest number of parallel axes that fit the width of a sheet."""


def page(swept: Swept) -> Page:
    """The page of a sweep."""
    sentences = [f"{swept.requested} variants: {counts(swept)}."]
    if not swept.best:
        sentences.append(_nothing(swept))
    return Page(
        name=swept.study.design.name,
        kind="Sweep",
        verdict=_verdict(swept),
        sentence=" ".join(sentences),
        tiles=list(_tiles(swept)),
        hero=lambda room: _hero(swept),
        blocks=list(_blocks(swept)),
    )


def counts(swept: Swept) -> str:
    """Sentence on how many designs were computed, failed and are feasible.

    For a sweep that keeps only the best designs: how many were ruled out early and how many were
    evaluated in full.
    """
    if swept.feasible is None:
        full = swept.computed - swept.screened
        return f"{swept.screened} ruled out early, {full} evaluated in full"
    reused = f", {swept.reused} reused" if swept.reused else ""
    return f"{swept.computed} computed{reused}, {swept.failed} failed, {swept.feasible} feasible"


def _verdict(swept: Swept) -> Verdict:
    """Badge at the top: whether any design is feasible, and how many of the best lack margin."""
    if not swept.best:
        words = "NO OBJECTIVE VALUE" if swept.feasible else "NO FEASIBLE DESIGN"
        return Verdict("missed", words)
    tight = sum(best.margin < NO_RESERVE for best in swept.best)
    limit = f"least margin below {100 * NO_RESERVE:g} %"
    cautions = [f"{tight} of the best designs: no reserve ({limit})"] if tight else []
    return Verdict("checks" if tight else "met", "FEASIBLE", cautions=cautions)


def _nothing(swept: Swept) -> str:
    """Sentences on the reason why there is no best design."""
    if swept.feasible:
        return f"The objective has no value for any of the {swept.feasible} feasible designs."
    missed = sorted(swept.missed.items(), key=lambda item: (-item[1], item[0]))
    if not missed:
        return "No variant has finite results."
    name, times = missed[0]
    whom = (
        "them" if swept.feasible is not None else f"{sum(swept.missed.values())} designs examined"
    )
    words = (
        f"None meets every requirement and check; in {times} of {whom}, the limit missed by the "
        f"largest margin is {name}"
    )
    return f"{words}. Widen the varied ranges, or run `optimise` to see which limits conflict."


def _tiles(swept: Swept) -> Iterator[Tile]:
    """Key figures: counts, and the best design's objective and smallest margin."""
    yield Tile("variants", str(swept.requested))
    if swept.feasible is not None:
        yield Tile("feasible", str(swept.feasible))
    if swept.best:
        best = swept.best[0]
        single = swept.study.goal.single
        if single is not None:
            value = text.value_text(swept.study.quantity(single), swept.metrics(best)[single])
            yield tile(f"best {single.replace('_', ' ')}", value, "")
        yield tile("its least margin", text.margin_text(best.margin), "")


def _hero(swept: Swept) -> Ink:
    """Parallel axes; empty unless the sweep keeps every design and at least one is feasible."""
    study = swept.study
    if swept.best and study.full:
        metrics = chosen(study, ())[: max(1, AXES - len(study.plan.axes))]
        try:
            return parallel_figure(SweepFigureData(swept), metrics)
        except InputError:  # a metric without values
            pass
    return Ink(180.0, 1.0)


def _blocks(swept: Swept) -> Iterator[Block]:
    if swept.best:
        yield _best(swept)
    remarks = []
    if swept.damaged:
        rows = "1 row" if swept.damaged == 1 else f"{swept.damaged} rows"
        remarks.append(f"{rows} in the store were damaged and computed again.")
    reasons = sorted(swept.failures.items(), key=lambda item: (-item[1], item[0]))
    remarks += [f"failed: {times} times {reason}" for reason, times in reasons[:FAILURES]]
    if len(reasons) > FAILURES:
        remarks.append(f"and {len(reasons) - FAILURES} more reasons")
    if remarks:
        yield Notes("Failures", remarks, headless=True)
    rate = swept.computed / swept.seconds if swept.seconds > 0 else 0.0
    time = f"computing time ({swept.seconds:.1f} s, {rate:.0f}/s)"
    yield Notes("", [time], headless=True, style="dim", on="terminal")


def _best(swept: Swept) -> Table:
    """Table of the best designs with their varied inputs, objective and smallest margin."""
    study = swept.study
    goal = list(study.goal.weights)
    paths = [axis.path for axis in study.plan.axes]
    quantities: dict[str, Quantity | None] = {
        axis.path: None if axis.values is None else quantity_of(axis.path, study.design)
        for axis in study.plan.axes
    }
    columns = [
        Column("", "right"),
        *(
            Column(_head(_short(path, paths), quantities[path]), "right", 1.0, breaks=14)
            for path in paths
        ),
        *(Column(_head(name, study.quantity(name)), "right") for name in goal),
        Column("least margin", "right", style="state"),
    ]
    rows = []
    for place, best in enumerate(swept.best, start=1):
        values, metrics = swept.values(best), swept.metrics(best)
        cells = [
            str(place),
            *(_cell(values[path], quantities[path]) for path in paths),
            *(text.number(text.display(study.quantity(name), metrics[name])) for name in goal),
            text.margin_text(best.margin),
        ]
        rows.append(Row(cells, "no_reserve" if best.margin < NO_RESERVE else ""))
    return Table("Best designs", columns, rows)


def _head(name: str, quantity: Quantity | None) -> str:
    return f"{name}, {quantity.unit}" if quantity is not None and quantity.unit else name


def _short(path: str, paths: list[str]) -> str:
    """The shortest ending by which a PATH differs from all other PATHs."""
    parts = path.split(".")
    for count in range(1, len(parts)):
        tail = ".".join(parts[-count:])
        if not any(other != path and other.endswith(f".{tail}") for other in paths):
            return tail
    return path


def _cell(value: float | str, quantity: Quantity | None) -> str:
    if quantity is None or isinstance(value, str):
        return str(value)
    return text.number(quantity.to_display(value))


# ---- rows ----


class SweepColumns:
    """The designs of a sweep as columns for CSV and Parquet files, in display units.

    The columns: number of the design, varied inputs, metrics, smallest margin and its limit,
    whether all limits are met, and the reason of a failure.
    """

    def __init__(self, study: Study) -> None:
        self.study = study
        count, margin = len(study.plan.numeric), study.columns[-3].name
        named: list[tuple[str, str, Quantity | None]] = [
            *(
                (column.name, column.name, quantity_of(column.name, study.design))
                for column in study.columns[:count]
            ),
            *((x, study.quantity(x).label, study.quantity(x)) for x in study.metrics),
            (margin, "least margin of all limits, as a share of the limit", None),
        ]
        self._quantities = [quantity for _, _, quantity in named]
        self.fields = [
            FileColumn("number", "whole", "number of the design in the plan of the sweep"),
            *(FileColumn(axis.path, "text", axis.path, axis.path) for axis in study.plan.named),
            *(_number(name, label, quantity) for name, label, quantity in named),
            FileColumn("governing_limit", "text", "limit that has the least margin"),
            FileColumn("feasible", "flag", "whether every limit is met"),
            FileColumn("failure", "text", "reason of missing results"),
        ]

    def values(self, chunk: Chunk) -> list[Values]:
        """The values of a chunk of designs, column by column."""
        count, failures = len(chunk.rows.numbers), chunk.rows.failures
        failed = np.zeros(count, dtype=bool)
        failed[list(failures)] = True
        reasons = list(dict.fromkeys(failures.values()))
        why = np.full(count, -1)
        why[list(failures)] = [reasons.index(reason) for reason in failures.values()]
        limits = np.where(failed, -1, np.nan_to_num(chunk.rows.numbers[:, -2])).astype(int)
        return [
            np.arange(chunk.first, chunk.first + count),
            *self._named(chunk, count),
            *self._numbers(chunk),
            Coded(limits, self.study.limits),
            np.where(failed, np.nan, chunk.feasible),
            Coded(why, reasons),
        ]

    def _named(self, chunk: Chunk, count: int) -> Iterator[Coded]:
        """Columns of the varied inputs whose values are names (such as materials)."""
        plan = self.study.plan
        if not plan.named:
            return
        known, which = np.unique(plan.points(chunk.first, count).variant, return_inverse=True)
        texts = [plan.texts(int(variant)) for variant in known]
        for axis in plan.named:
            codes = np.array([axis.texts.index(words[axis.path]) for words in texts])
            yield Coded(codes[which], axis.texts)

    def _numbers(self, chunk: Chunk) -> Iterator[Array]:
        """Columns of numbers; NaN for a missing number."""
        for k, quantity in enumerate(self._quantities):
            column = chunk.rows.numbers[:, k]
            yield column if quantity is None else quantity.to_display(column)


def _number(name: str, label: str, quantity: Quantity | None) -> FileColumn:
    unit = "" if quantity is None else quantity.unit
    return FileColumn(heading(name, unit), "number", label, name, unit)


def about(study: Study) -> dict[str, str]:
    """Metadata of a sweep for a file: design, plan and version."""
    plan = study.plan
    points = {
        "method": plan.method,
        "count": plan.count,
        "seed": plan.seed,
        "vary": {axis.path: _axis(axis) for axis in plan.axes},
    }
    origin = {
        "name": study.design.name,
        "version": VERSION,
        "spec_hash": spec_hash(prepare(study.design, plugins=study.plugins)),
        "study": study.hash,
        "plan": encoded(points, ensure_ascii=False),
        "design": study.text,
    }
    return {f"actuator_opt.{key}": value for key, value in origin.items()}


def _axis(axis: SweepAxis) -> object:
    """The values of a varied input in SI: a list, or ends and number of steps of a range."""
    if axis.values is None:
        return list(axis.texts)
    values = axis.values.tolist()
    return {"from": values[0], "to": values[-1], "steps": axis.count} if axis.range else values
