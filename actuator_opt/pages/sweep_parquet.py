"""The rows of a sweep as Apache Parquet, row group by row group: aside, in place once complete.

The columns are those of the CSV, typed: numbers in double precision (null where there is none),
texts by dictionaries, verdicts as booleans. Every field has its PATH or metric, its label and its
unit as metadata, the file has what its rows rest on.
"""

from __future__ import annotations

from contextlib import AbstractContextManager, ExitStack
from pathlib import Path
from types import TracebackType
from typing import Any

import numpy as np

from ..base.extras import library
from ..base.files import aside_bytes, writing
from ..base.numeric import Array
from ..base.plain_json import encoded
from ..evaluation import prepare
from ..evaluation.build import spec_hash
from ..sweeps.axes import Axis
from ..sweeps.chunk import Chunk, Study
from ..version import VERSION
from .sweep_columns import FAILURE, LIMIT, MET, NUMBER, SweepColumns

GROUP = 32_768
"""Rows from which a row group is written: what is held at once."""


class SweepParquet(AbstractContextManager["SweepParquet"]):
    """A Parquet file of a sweep.

    Raises
    ------
    ActuatorError
        pyarrow is not installed
    """

    def __init__(self, study: Study, path: Path) -> None:
        self._arrow, self._parquet = library("pyarrow"), library("pyarrow.parquet")
        self.study, self.path = study, path
        self._columns = SweepColumns(study)
        self._schema = self._arrow.schema(self._fields(), metadata=_told(study))
        self._waiting: list[Any] = []

    def __enter__(self) -> SweepParquet:
        with ExitStack() as stack:
            stream = stack.enter_context(aside_bytes(self.path))
            self._writer = self._parquet.ParquetWriter(
                stream, self._schema, compression="zstd", use_dictionary=self._texts
            )
            stack.push(self._end)
            self._stack = stack.pop_all()
        return self

    def add(self, chunk: Chunk) -> None:
        """Keep a chunk, and write what is a row group."""
        self._waiting.append(self._batch(chunk))
        if sum(one.num_rows for one in self._waiting) >= GROUP:
            with writing(self.path):
                self._write()

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._stack.__exit__(kind, error, trace)

    def _end(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Write what is left, unless the sweep failed; whatever happens, the writer is done."""
        try:
            if error is None:
                self._write()
                self._writer.close()
        finally:
            self._writer.is_open = False  # else it ends the file again when it is forgotten

    @property
    def _texts(self) -> list[str]:
        """Columns of texts."""
        return [*self._columns.named, LIMIT, FAILURE]

    def _fields(self) -> list[Any]:
        arrow = self._arrow
        text = arrow.dictionary(arrow.int32(), arrow.string())

        def field(head: str, kind: Any, label: str, **more: str) -> Any:
            return arrow.field(head, kind, metadata={"label": label, **more})

        return [
            field(NUMBER, arrow.int64(), "number of the design in its plan"),
            *(field(path, text, path, name=path) for path in self._columns.named),
            *(
                field(one.head, arrow.float64(), one.label, name=one.name, unit=one.unit or "1")
                for one in self._columns.figures
            ),
            field(LIMIT, text, "limit of the least margin"),
            field(MET, arrow.bool_(), "whether every limit is met"),
            field(FAILURE, text, "why there is no answer"),
        ]

    def _batch(self, chunk: Chunk) -> Any:
        """A chunk in columns."""
        arrow, plan, rows = self._arrow, self.study.plan, chunk.rows
        count = len(rows.numbers)
        variants, numbers = self._columns.variants(chunk), self._columns.shown(chunk)
        known, which = np.unique(variants, return_inverse=True)
        texts = [plan.texts(int(one)) for one in known]
        failed = np.zeros(count, dtype=bool)
        failed[list(rows.failures)] = True
        reasons = list(dict.fromkeys(rows.failures.values()))
        why = np.zeros(count, dtype=np.int32)
        why[list(rows.failures)] = [reasons.index(one) for one in rows.failures.values()]
        limits = np.where(failed, 0, np.nan_to_num(rows.numbers[:, -2])).astype(np.int32)

        def coded(codes: Array, words: Any, hidden: Array | None = None) -> Any:
            indices = arrow.array(codes.astype(np.int32), mask=hidden)
            return arrow.DictionaryArray.from_arrays(indices, arrow.array(words, arrow.string()))

        columns = [arrow.array(np.arange(chunk.first, chunk.first + count))]
        for axis in plan.named:
            codes = np.array([axis.texts.index(one[axis.path]) for one in texts])
            columns.append(coded(codes[which], axis.texts))
        columns += [arrow.array(one, mask=np.isnan(one)) for one in numbers.T]
        columns += [
            coded(limits, self.study.limits, failed),
            arrow.array(chunk.feasible, mask=failed),
            coded(why, reasons, ~failed),
        ]
        return arrow.record_batch(columns, schema=self._schema)

    def _write(self) -> None:
        """Write what waits as one row group."""
        if self._waiting:
            table = self._arrow.Table.from_batches(self._waiting, self._schema)
            self._waiting = []
            self._writer.write_table(table.unify_dictionaries(), row_group_size=table.num_rows)


def _told(study: Study) -> dict[str, str]:
    """What the rows rest on, under keys of the file."""
    plan = study.plan
    points = {
        "method": plan.method,
        "count": plan.count,
        "seed": plan.seed,
        "vary": {axis.path: _values(axis) for axis in plan.axes},
    }
    told = {
        "name": study.design.name,
        "version": VERSION,
        "spec_hash": spec_hash(prepare(study.design, plugins=study.plugins)),
        "study": study.hash,
        "plan": encoded(points, ensure_ascii=False),
        "design": study.text,
    }
    return {f"actuator_opt.{key}": value for key, value in told.items()}


def _values(axis: Axis) -> object:
    """The values of an axis in SI: a list, or the ends and the steps of a range."""
    if axis.values is None:
        return list(axis.texts)
    values = axis.values.tolist()
    return {"from": values[0], "to": values[-1], "steps": axis.count} if axis.range else values
