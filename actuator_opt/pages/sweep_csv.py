"""The rows of a sweep as CSV, written as they come: aside, and in place once they are complete."""

from __future__ import annotations

from contextlib import AbstractContextManager
from pathlib import Path
from types import TracebackType

from ..base.files import aside, writing
from ..sweeps.chunk import Chunk, Study
from .sweep_columns import SweepColumns


class SweepTable(AbstractContextManager["SweepTable"]):
    """A CSV of a sweep."""

    def __init__(self, study: Study, path: Path) -> None:
        self.study, self.path = study, path
        self._columns = SweepColumns(study)

    def __enter__(self) -> SweepTable:
        self._aside = aside(self.path)
        self._stream = self._aside.__enter__()
        self._stream.write(",".join(map(_quoted, self._columns.heads)) + "\n")
        return self

    def add(self, chunk: Chunk) -> None:
        """Write a chunk."""
        study, named = self.study, self._columns.named
        variants = self._columns.variants(chunk).tolist()
        lines = []
        pattern = ",".join(["%.9g"] * len(self._columns.figures))
        for k, row in enumerate(self._columns.shown(chunk).tolist()):
            failure = chunk.rows.failures.get(k, "")
            first = [str(chunk.first + k)]
            if named:
                texts = study.plan.texts(variants[k])
                first += [_quoted(texts[path]) for path in named]
            middle = (pattern % tuple(row)).replace("nan", "")
            last = ["", "", _quoted(failure)]
            if not failure:
                limit = study.limits[int(chunk.rows.numbers[k, -2])]
                last[:2] = _quoted(limit), "yes" if chunk.feasible[k] else "no"
            lines.append(",".join([*first, middle, *last]) + "\n")
        with writing(self.path):
            self._stream.writelines(lines)

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
