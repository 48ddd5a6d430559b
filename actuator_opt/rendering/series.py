"""Columns of numbers as a CSV file."""

from __future__ import annotations

import csv
import hashlib
import io
from collections.abc import Sequence
from dataclasses import dataclass
from math import isnan
from pathlib import Path
from typing import Any

from ..base.files import write_text
from .paper import ReportFile


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
