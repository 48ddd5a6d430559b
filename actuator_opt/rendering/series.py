"""Columns as CSV files: whole ones, and files that grow by rows."""

from __future__ import annotations

import csv
import hashlib
import io
from collections.abc import Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass
from math import isnan
from pathlib import Path
from types import TracebackType
from typing import Any, Literal, NamedTuple, TypeAlias

from ..base.files import aside, write_text, writing
from ..base.numeric import Array
from .origin import ReportFile


@dataclass(frozen=True, slots=True)
class Series:
    """A column: its head with the unit, and its values (numbers, text, None where missing).

    `digits` are the significant digits of its numbers; whole numbers have all of theirs. `form`,
    where given, is their format instead: ``"5f"`` are five decimals.
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
    """The columns as CSV; a value that is None or not a number stays empty."""
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
    """Write the columns as a CSV file, whole or not at all."""
    text = csv_text(columns)
    write_text(path, text)
    return ReportFile(path, hashlib.sha256(text.encode()).hexdigest(), 1)


def _cell(value: Any, form: str) -> str:
    if value is None:
        return ""
    if isinstance(value, str):
        return value
    if isinstance(value, bool) or (float(value).is_integer() and isinstance(value, int)):
        return str(int(value))
    return "" if isnan(value) else f"{value:.{form}}"


# ---- files that grow by rows ----


@dataclass(frozen=True, slots=True)
class Field:
    """A column of a file that grows: its head, the kind of its cells, and what they mean.

    `name` is a path or a metric, `unit` that of a number.
    """

    head: str
    kind: Literal["whole", "number", "flag", "text"]
    label: str
    name: str = ""
    unit: str = ""


class Coded(NamedTuple):
    """Texts by their place among `words`; a negative code is an empty cell."""

    codes: Array
    words: Sequence[str]


Values: TypeAlias = Array | Coded
"""Cells of a column: numbers and flags (1 or 0; NaN is an empty cell), or texts."""


class CsvFile(AbstractContextManager["CsvFile"]):
    """A CSV file that grows by rows: written aside, and in place once it is complete."""

    def __init__(self, fields: Sequence[Field], path: Path) -> None:
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


def _cells(field: Field, values: Values) -> list[str]:
    """Cells of a column as written to a CSV file."""
    if isinstance(values, Coded):
        words = [*map(_quoted, values.words), ""]
        return [words[max(code, -1)] for code in values.codes.tolist()]
    if field.kind == "flag":
        return ["yes" if x == 1 else "no" if x == 0 else "" for x in values.tolist()]
    pattern = "%d\n" if field.kind == "whole" else "%.9g\n"
    return (pattern * len(values) % tuple(values.tolist())).replace("nan", "").splitlines()


def _quoted(text: str) -> str:
    """A text as a CSV cell."""
    return '"' + text.replace('"', '""') + '"' if any(c in text for c in ',"\n\r') else text
