"""Columns as Apache Parquet, row group by row group: aside, and in place once complete.

Numbers are stored in double precision (null where there is none), texts by dictionaries, flags as
booleans. Every field carries its name, label and unit as metadata.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import AbstractContextManager, ExitStack
from pathlib import Path
from types import TracebackType
from typing import Any

import numpy as np

from ..base.errors import library
from ..base.files import aside_bytes, writing
from .series import Coded, Field, Values

GROUP = 32_768
"""Rows from which a row group is written: all that memory holds at once."""


class ParquetFile(AbstractContextManager["ParquetFile"]):
    """A Parquet file that grows by rows.

    Parameters
    ----------
    fields : its columns
    about : metadata of the file
    path : of the file

    Raises
    ------
    ActuatorError
        pyarrow is not installed
    """

    def __init__(self, fields: Sequence[Field], about: Mapping[str, str], path: Path) -> None:
        self._arrow, self._parquet = library("pyarrow"), library("pyarrow.parquet")
        self.fields, self.path = fields, path
        self._schema = self._arrow.schema(list(map(self._field, fields)), metadata=about)
        self._waiting: list[Any] = []

    def __enter__(self) -> ParquetFile:
        texts = [field.head for field in self.fields if field.kind == "text"]
        with ExitStack() as stack:
            stream = stack.enter_context(aside_bytes(self.path))
            self._writer = self._parquet.ParquetWriter(
                stream, self._schema, compression="zstd", use_dictionary=texts
            )
            stack.push(self._end)
            self._stack = stack.pop_all()
        return self

    def add(self, columns: Sequence[Values]) -> None:
        """Keep rows, and write what makes a row group."""
        cells = list(map(self._cells, self.fields, columns))
        self._waiting.append(self._arrow.record_batch(cells, schema=self._schema))
        if sum(batch.num_rows for batch in self._waiting) >= GROUP:
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
        """Write what is left, unless the work failed; in any case the writer is done."""
        try:
            if error is None:
                self._write()
                self._writer.close()
        finally:
            self._writer.is_open = False  # else it ends the file again when it is forgotten

    def _field(self, field: Field) -> Any:
        arrow = self._arrow
        kinds = {
            "whole": arrow.int64(),
            "number": arrow.float64(),
            "flag": arrow.bool_(),
            "text": arrow.dictionary(arrow.int32(), arrow.string()),
        }
        about = {"label": field.label}
        about |= {"name": field.name} if field.name else {}
        about |= {"unit": field.unit or "1"} if field.kind == "number" else {}
        return arrow.field(field.head, kinds[field.kind], metadata=about)

    def _cells(self, field: Field, values: Values) -> Any:
        arrow = self._arrow
        if isinstance(values, Coded):
            codes = arrow.array(values.codes.astype(np.int32), mask=values.codes < 0)
            words = arrow.array(list(values.words), arrow.string())
            return arrow.DictionaryArray.from_arrays(codes, words)
        if field.kind == "whole":
            return arrow.array(values)
        missing = np.isnan(values)
        return arrow.array(values == 1.0 if field.kind == "flag" else values, mask=missing)

    def _write(self) -> None:
        """Write what waits as one row group."""
        if self._waiting:
            table = self._arrow.Table.from_batches(self._waiting, self._schema)
            self._waiting = []
            self._writer.write_table(table.unify_dictionaries(), row_group_size=table.num_rows)
