"""The rows of a sweep as CSV, written as they come: aside, and in place once they are complete."""

from __future__ import annotations

from contextlib import AbstractContextManager
from pathlib import Path
from types import TracebackType

from ..design.paths import quantity_of
from ..quantities import Quantity
from ..store import aside
from ..variants.chunk import Chunk, Study
from .simulation_csv import heading


class SweepTable(AbstractContextManager["SweepTable"]):
    """A CSV of a sweep: what varies, metrics, the least margin, why a design failed.

    Values stand in the unit people read, which the header names.
    """

    def __init__(self, study: Study, path: Path) -> None:
        self.study, self.path = study, path
        plan, design = study.plan, study.design
        told: list[Quantity | None] = [
            quantity_of(column.name, design) for column in study.columns[: len(plan.numeric)]
        ]
        told += [study.quantity(name) for name in study.metrics]
        self._told = [*told, None, None, None]
        self._named = [axis.path for axis in plan.named]
        names = [column.name for column in study.columns]
        heads = [
            heading(name, "" if one is None else one.unit)
            for name, one in zip(names, self._told, strict=True)
        ]
        self._heads = ["number", *self._named, *heads, "failure"]

    def __enter__(self) -> SweepTable:
        self._aside = aside(self.path)
        self._stream = self._aside.__enter__()
        self._stream.write(",".join(map(_quoted, self._heads)) + "\n")
        return self

    def add(self, chunk: Chunk) -> None:
        """Write a chunk."""
        numbers, study = chunk.rows.numbers, self.study
        shown = numbers.copy()
        for k, quantity in enumerate(self._told):
            if quantity is not None:
                shown[:, k] = quantity.to_display(numbers[:, k])
        points = study.plan.points(chunk.first, len(numbers)) if self._named else None
        pattern = ",".join(["%.9g"] * (len(self._heads) - len(self._named) - 4))
        for k, row in enumerate(shown[:, :-2].tolist()):
            failure = chunk.rows.failures.get(k, "")
            first = [str(chunk.first + k)]
            if points is not None:
                texts = study.plan.texts(int(points.variant[k]))
                first += [_quoted(texts[path]) for path in self._named]
            middle = (pattern % tuple(row)).replace("nan", "")
            last = ["", "", _quoted(failure)]
            if not failure:
                limit = study.limits[int(numbers[k, -2])]
                last[:2] = _quoted(limit), "yes" if chunk.feasible[k] else "no"
            self._stream.write(",".join([*first, middle, *last]) + "\n")

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._aside.__exit__(kind, error, trace)


def _quoted(text: str) -> str:
    """A text as a CSV cell."""
    return '"' + text.replace('"', '""') + '"' if any(c in text for c in ',"\n\r') else text
