"""Write columns of data to files: CSV (all at once or row by row) and Apache Parquet.

Parquet stores numbers in double precision (null if missing), texts with dictionary encoding, and
flags as booleans. Its metadata give the name, label and unit of every field. A file has a temporary
name until it is complete.
"""

from __future__ import annotations

import csv
import hashlib
import io
from collections.abc import Mapping, Sequence
from contextlib import AbstractContextManager, ExitStack
from math import isnan
from pathlib import Path
from types import TracebackType
from typing import Any, Literal, NamedTuple, TypeAlias

import numpy as np

from ..base.dataclass import dataclass
from ..base.errors import library
from ..base.files import aside, aside_bytes, write_text, writing
from ..base.numeric import Array
from .blocks import ReportFile


@dataclass(frozen=True, slots=True)
class Series:
    """A column: its head with the unit, and its values (numbers, text, None where missing).

    Numbers have `digits` significant digits; whole numbers have all their digits. If a format
    `form` is given, it applies instead; ``"5f"``, for example, gives five decimals.
    """

    head: str
    values: Sequence[Any]
    digits: int = 7
    form: str = ""


def heading(name: str, unit: str) -> str:
    """The head of a column, with the unit.

    >>> heading("position", "mm"), heading("phase", "")
    ('position [mm]', 'phase')
    """
    return f"{name} [{unit}]" if unit else name


def csv_text(columns: Sequence[Series]) -> str:
    """The columns as CSV; the cells of None and NaN are empty."""
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow([column.head for column in columns])
    texts = [
        [_cell(value, column.form or f"{column.digits}g") for value in column.values]
        for column in columns
    ]
    writer.writerows(zip(*texts, strict=True))
    return stream.getvalue()


def write_csv(columns: Sequence[Series], path: Path) -> ReportFile:
    """Write the columns as a CSV file, completely or not at all."""
    text = csv_text(columns)
    write_text(path, text)
    return ReportFile(path, hashlib.sha256(text.encode()).hexdigest(), 1)


def _cell(value: Any, form: str) -> str:
    if value is None:
        return ""
    if isinstance(value, str):
        return inert(value)
    if isinstance(value, bool) or (float(value).is_integer() and isinstance(value, int)):
        return str(int(value))
    return "" if isnan(value) else f"{value:.{form}}"


# ---- files that grow by rows ----


@dataclass(frozen=True, slots=True)
class FileColumn:
    """A column of a file that is written row by row: its head, kind of cells, and label.

    `name` is the name of the metric in the column, or the path of a design variable in the design
    file (PATH). Columns of numbers have a `unit`.
    """

    head: str
    kind: Literal["whole", "number", "flag", "text"]
    label: str
    name: str = ""
    unit: str = ""


class Coded(NamedTuple):
    """Texts stored as indices into `words`; a negative index is an empty cell."""

    codes: Array
    words: Sequence[str]


Values: TypeAlias = Array | Coded
"""Cells of a column: numbers and flags (1 or 0; NaN is an empty cell), or texts."""


class CsvFile(AbstractContextManager["CsvFile"]):
    """A CSV file that is written row by row under a temporary name, and renamed when complete."""

    def __init__(self, fields: Sequence[FileColumn], path: Path) -> None:
        self.fields, self.path = fields, path

    def __enter__(self) -> CsvFile:
        self._aside = aside(self.path)
        self._stream = self._aside.__enter__()
        self._stream.write(",".join(_quoted(field.head) for field in self.fields) + "\n")
        return self

    def add(self, columns: Sequence[Values]) -> None:
        """Write rows."""
        cells = map(_cells, self.fields, columns)
        lines = [",".join(row) + "\n" for row in zip(*cells, strict=True)]
        with writing(self.path):
            self._stream.writelines(lines)

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._aside.__exit__(kind, error, trace)


def _cells(field: FileColumn, values: Values) -> list[str]:
    """Cells of a column as written to a CSV file."""
    if isinstance(values, Coded):
        words = [*map(_quoted, values.words), ""]
        return [words[max(code, -1)] for code in values.codes.tolist()]
    if field.kind == "flag":
        return ["yes" if x == 1 else "no" if x == 0 else "" for x in values.tolist()]
    pattern = "%d\n" if field.kind == "whole" else "%.9g\n"
    return (pattern * len(values) % tuple(values.tolist())).replace("nan", "").splitlines()


def inert(text: str) -> str:
    """A text that no spreadsheet takes for a formula: with an apostrophe in front if needed.

    >>> inert("=1+2"), inert("steel")
    ("'=1+2", 'steel')
    """
    return f"'{text}" if text.startswith(("=", "+", "-", "@", "\t", "\r")) else text


def _quoted(text: str) -> str:
    """A text as a CSV cell."""
    text = inert(text)
    return '"' + text.replace('"', '""') + '"' if any(c in text for c in ',"\n\r') else text


GROUP = 32_768
"""Number of rows in memory at which a row group is written."""


class ParquetFile(AbstractContextManager["ParquetFile"]):
    """A Parquet file that is written in groups of rows.

    Parameters
    ----------
    fields : columns of the file
    about : metadata of the file
    path : path of the file

    Raises
    ------
    ActuatorError
        pyarrow is not installed
    """

    def __init__(self, fields: Sequence[FileColumn], about: Mapping[str, str], path: Path) -> None:
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
        """Store rows in memory, and write full row groups."""
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
        """Write the remaining rows and close the writer; after an error, write nothing more."""
        try:
            if error is None:
                self._write()
                self._writer.close()
        finally:
            self._writer.is_open = False  # otherwise its destructor would end the file again

    def _field(self, field: FileColumn) -> Any:
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

    def _cells(self, field: FileColumn, values: Values) -> Any:
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
        """Write the rows that are in memory to the file, as a row group."""
        if self._waiting:
            table = self._arrow.Table.from_batches(self._waiting, self._schema)
            self._waiting = []
            self._writer.write_table(table.unify_dictionaries(), row_group_size=table.num_rows)
