"""Units of columns whose heading states none: SI for all, or given column by column."""

from __future__ import annotations

import csv
from collections.abc import Mapping
from dataclasses import field
from pathlib import Path

from ..base import units
from ..base.dataclass import dataclass
from ..base.errors import Diagnostic, InputError, shown
from ..base.files import read_bytes
from ..design.yaml_source import MAX_BYTES, decode, parse

SI = "SI"
"""Word by which a user states that all columns without a unit are in SI: m, s, Pa, N, m/s, K."""
_WHAT = "units"


@dataclass(frozen=True, slots=True)
class ColumnUnits:
    """Units of columns whose heading states none; a unit in the heading takes precedence.

    Parameters
    ----------
    stated : unit by name of the column
    si : whether all other columns without a unit are in SI
    name : source of the units, for messages
    """

    stated: Mapping[str, str] = field(default_factory=dict)
    si: bool = False
    name: str = _WHAT

    def of(self, column: str, dimension: str) -> str:
        """Unit of a column whose heading states none; empty if unknown."""
        return self.stated.get(column) or (units.BASE[dimension] if self.si else "")


NONE = ColumnUnits()


def column_units(source: str | Path | Mapping[str, str] | None) -> ColumnUnits:
    """Units of columns from the word ``"SI"``, a mapping by column, or a file.

    A YAML file (``.yaml``, ``.yml``) has lines such as ``p1: bar``, any other file has lines such
    as ``p1,bar``. Both give the name of the column as in its heading, and its unit. Columns that
    the record does not have are ignored.

    Parameters
    ----------
    source : ``"SI"``, a unit by column, the path of a file, or None

    Returns
    -------
    the units

    Raises
    ------
    InputError
        a file that does not exist, a line without column and unit, or a column given twice
    """
    if source is None:
        return NONE
    if isinstance(source, Mapping):
        return ColumnUnits(dict(source))
    if str(source) == SI:
        return ColumnUnits(si=True, name=SI)
    file = str(source)
    kinds = (".csv", ".yaml", ".yml", ".txt")
    data = read_bytes(source, most=MAX_BYTES + 1, kinds=kinds, what="file of units")
    text = decode(data, file, _WHAT)
    of_yaml = Path(file).suffix.lower() in (".yaml", ".yml")
    return ColumnUnits(_yaml(text, file) if of_yaml else _csv(text, file), name=file)


def _yaml(text: str, file: str) -> dict[str, str]:
    document = parse(text, file, _WHAT)
    faults = list(document.faults)
    for column, unit in document.data.items():
        if not isinstance(unit, str) or not unit.strip():
            span = document.keys.get((column,))
            message = f'column "{shown(column)}" has no unit'
            faults.append(document.diagnostic(span, message, "write e.g. p1: bar"))
    if faults:
        raise InputError(faults)
    return {column: unit.strip() for column, unit in document.data.items()}


def _csv(text: str, file: str) -> dict[str, str]:
    unit_by_column: dict[str, str] = {}
    faults: list[Diagnostic] = []
    for number, line in enumerate(text.splitlines(), 1):
        if not line.strip() or line.lstrip().startswith("#"):
            continue
        separator = next((sign for sign in "\t;," if sign in line), ",")
        cells = [cell.strip() for cell in next(csv.reader([line], delimiter=separator))]
        message, remedy = "", "write the column and its unit, e.g. p1,bar"
        if len(cells) != 2 or not all(cells):
            message = f'"{shown(line)}" is not a column with its unit'
        elif cells[0] in unit_by_column:
            message, remedy = f'column "{shown(cells[0])}" is named twice', "delete one line"
        if message:
            faults.append(Diagnostic(message, remedy, file=file, line=number))
        else:
            unit_by_column[cells[0]] = cells[1]
    if faults:
        raise InputError(faults)
    return unit_by_column
