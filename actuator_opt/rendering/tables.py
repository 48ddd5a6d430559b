"""Tables of results as arrays, which also become CSV and frames of other packages.

Numbers are double precision in SI, NaN where missing. Texts are stored once, with an index for each
row, so that a million rows of a sweep take as much memory as their numbers.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, Literal, TypeAlias, get_args

import numpy as np

from ..base.dataclass import dataclass
from ..base.errors import (
    Diagnostic,
    InputError,
    UnknownName,
    UsageError,
    library as package,
    remedy,
    shown,
)
from ..base.numeric import Array
from ..base.quantities import Quantity, short
from ..base.tables import OneLine, aligned
from .blocks import Column as PageColumn, Table
from .series import Coded, CsvFile, FileColumn, Values, heading

Units: TypeAlias = Literal["si", "display"]
"""Units of numbers: SI, or those in which reports show each quantity."""
Library: TypeAlias = Literal["pandas", "polars", "pyarrow"]

ROWS = 20
"""Number of rows that are shown (our choice: they fit a screen)."""
COLUMNS = 16
"""Number of columns that are shown in a notebook (our choice)."""
WIDTH = 100
"""Width of a printed table in characters."""
CHUNK = 16_384
"""Number of rows that are written to a file at once."""


@dataclass(frozen=True, slots=True, eq=False)
class DataColumn:
    """A column: numbers in SI, flags, or texts.

    `quantity` is that of all numbers in the column. `display` has the values in display units if
    the rows have different quantities.
    """

    name: str
    values: Values
    quantity: Quantity | None = None
    display: Values | None = None

    def shown(self, units: Units) -> Values:
        """The values in SI or in display units."""
        if units == "si":
            return self.values
        if self.display is not None:
            return self.display
        if self.quantity is None or isinstance(self.values, Coded):
            return self.values
        displayed: Array = np.asarray(self.quantity.to_display(self.values))
        return displayed

    def unit(self, units: Units) -> str:
        """Unit of the whole column; "" without one."""
        if self.quantity is None:
            return ""
        return self.quantity.si_unit if units == "si" else self.quantity.unit

    def some(self, places: Array | slice) -> DataColumn:
        """The column with some of its rows."""
        display = None if self.display is None else _some(self.display, places)
        return DataColumn(self.name, _some(self.values, places), self.quantity, display)


def _some(values: Values, places: Array | slice) -> Values:
    if isinstance(values, Coded):
        return Coded(values.codes[places], values.words)
    some: Array = values[places]
    return some


def coded(texts: Sequence[str | None]) -> Coded:
    """Texts as indices into the different ones; None is a missing text.

    >>> coded(["a", None, "b", "a"]).codes.tolist()
    [0, -1, 1, 0]
    """
    words = list(dict.fromkeys(text for text in texts if text is not None))
    place = {word: k for k, word in enumerate(words)}
    codes = [-1 if text is None else place[text] for text in texts]
    return Coded(np.array(codes, dtype=np.int32), words)


def _values(values: Sequence[Any]) -> Values:
    """Plain values as an array; texts, and columns without any value, are coded."""
    known = [value for value in values if value is not None]
    if known and all(isinstance(value, bool) for value in known) and len(known) == len(values):
        return np.array(values, dtype=bool)
    if known and not any(isinstance(value, str | bool) for value in known):
        return np.array([np.nan if value is None else value for value in values], dtype=float)
    return coded([None if value is None else str(value) for value in values])


def _texts(values: Coded) -> Array:
    """Texts of the rows, as objects; None where missing."""
    words = np.array([*values.words, None], dtype=object)
    texts: Array = words[values.codes]
    return texts


def _array(values: Values) -> Array:
    return _texts(values) if isinstance(values, Coded) else values


class DataTable(OneLine):
    """A table of results, with an array for each column; numbers are in SI.

    ``table["mass"]`` is the array of a column, ``len(table)`` the number of rows, and a loop over
    the table gives each row as a dict. No method changes a table; `where` and `sort` return others.
    """

    def __init__(self, name: str, columns: Sequence[DataColumn]) -> None:
        self.name = name
        self._columns = {column.name: column for column in columns}

    @classmethod
    def of(
        cls,
        name: str,
        columns: Mapping[str, Sequence[Any] | DataColumn],
        *,
        quantities: Sequence[Quantity | None] = (),
        scaled: Sequence[str] = (),
    ) -> DataTable:
        """A table of plain values (numbers, texts, flags, None).

        Parameters
        ----------
        name : name of the table
        columns : values by name of the column, SI; or a column that is made already
        quantities : quantity of each row, if these differ; a column `unit` is added
        scaled : columns of numbers with these quantities
        """
        made = []
        for title, values in columns.items():
            if isinstance(values, DataColumn):
                made.append(values)
                continue
            display = None
            if title in scaled:
                display = _values(
                    [
                        value if value is None or quantity is None else quantity.to_display(value)
                        for value, quantity in zip(values, quantities, strict=True)
                    ]
                )
            made.append(DataColumn(title, _values(values), None, display))
            if scaled and title == scaled[-1]:
                si = coded([None if q is None else q.si_unit for q in quantities])
                unit = coded([None if q is None else q.unit for q in quantities])
                made.append(DataColumn("unit", si, None, unit))
        return cls(name, made)

    @property
    def in_short(self) -> tuple[str, str]:
        """Name of the table, and its numbers of rows and columns."""
        return self.name, f"{len(self)} rows, {len(self._columns)} columns"

    def __len__(self) -> int:
        """Number of rows."""
        for column in self._columns.values():
            return len(column.values.codes if isinstance(column.values, Coded) else column.values)
        return 0

    def __iter__(self) -> Iterator[dict[str, Any]]:
        """Rows as dicts of plain values in SI; None where a value is missing."""
        for first in range(0, len(self), CHUNK):
            part = slice(first, first + CHUNK)
            cells = [_plain(_some(column.values, part)) for column in self._columns.values()]
            for row in zip(*cells, strict=True):
                yield dict(zip(self._columns, row, strict=True))

    def __getitem__(self, name: str) -> Array:
        """Values of a column: numbers in SI (NaN where missing), flags, or texts.

        Raises
        ------
        UnknownName : there is no such column
        """
        return _array(self._column(name).values)

    def __contains__(self, name: object) -> bool:
        """Whether there is a column of this name."""
        return name in self._columns

    def _ipython_key_completions_(self) -> list[str]:
        return [*self._columns]

    @property
    def columns(self) -> tuple[str, ...]:
        """Names of the columns."""
        return tuple(self._columns)

    @property
    def units(self) -> dict[str, str]:
        """SI unit of each column of numbers that has one unit."""
        units = {name: column.unit("si") for name, column in self._columns.items()}
        return {name: unit for name, unit in units.items() if unit}

    def where(self, rows: Array | Sequence[bool] | None = None, /, **equal: object) -> DataTable:
        """Rows for which a condition holds.

        Parameters
        ----------
        rows : whether to keep each row, such as ``table["mass"] < 0.3``
        equal : value that a column must have, such as ``met=True``

        Raises
        ------
        InputError : `rows` has another length, or is not of true and false
        """
        keep = np.ones(len(self), dtype=bool)
        if rows is not None:
            wanted = np.asarray(rows)
            if wanted.dtype != bool or wanted.shape != keep.shape:
                message = f"where: needs {len(self)} values, each true or false"
                raise InputError(Diagnostic(message, 'write e.g. table["mass"] < 0.3'))
            keep &= wanted
        for name, value in equal.items():
            keep &= np.asarray(self[name] == value, dtype=bool)
        return self._some(np.flatnonzero(keep))

    def sort(self, *names: str, descending: bool = False) -> DataTable:
        """The rows in the order of some columns; rows without a value are last."""
        order = np.arange(len(self))
        for name in reversed(names):
            order = order[_order(_some(self._column(name).values, order), descending)]
        return self._some(order)

    def _some(self, places: Array | slice) -> DataTable:
        return DataTable(self.name, [column.some(places) for column in self._columns.values()])

    def _column(self, name: str) -> DataColumn:
        column = self._columns.get(name) if isinstance(name, str) else None
        if column is None:
            fault = f'{self.name}: no column "{shown(name)}"'
            raise UnknownName(Diagnostic(fault, remedy(str(name), self._columns)))
        return column

    # ---- files and frames ----

    def to_csv(self, path: str | Path, *, units: Units = "display") -> Path:
        """Write the table as CSV, with units in the header; completely or not at all.

        A text that a spreadsheet would take for a formula (it begins with ``=``, ``+``, ``-`` or
        ``@``) gets an apostrophe in front.
        """
        _require(units, get_args(Units), "units")
        columns = [*self._columns.values()]
        shown_values = [column.shown(units) for column in columns]
        fields = [
            FileColumn(heading(column.name, column.unit(units)), _kind(values), column.name)
            for column, values in zip(columns, shown_values, strict=True)
        ]
        with CsvFile(fields, Path(path)) as file:
            for first in range(0, len(self), CHUNK):
                part = slice(first, first + CHUNK)
                file.add([_some(values, part) for values in shown_values])
        return Path(path)

    def to_frame(self, library: Library = "pandas", *, units: Units = "si") -> Any:
        """The table as a `pandas.DataFrame`, `polars.DataFrame` or `pyarrow.Table`.

        Names of columns are the same in both `units`. A column `unit` states the unit of each row;
        the units of whole columns are in ``frame.attrs["units"]`` (pandas) or in the metadata of
        the fields (pyarrow).

        Raises
        ------
        ActuatorError : the package is not installed; the message says how to install it
        """
        _require(library, _FRAMES, "library")
        _require(units, get_args(Units), "units")
        values = {name: column.shown(units) for name, column in self._columns.items()}
        stated = {name: column.unit(units) for name, column in self._columns.items()}
        return _FRAMES[library](values, {name: unit for name, unit in stated.items() if unit})

    def to_xarray(self, sizes: Mapping[str, int], *, units: Units = "si") -> Any:
        """The rows of a full factorial as an `xarray.Dataset`.

        Parameters
        ----------
        sizes : columns that are dimensions, with their numbers of values; the last changes fastest
        units : units of the numbers; each array states its unit in ``attrs``
        """
        _require(units, get_args(Units), "units")
        xarray = package("xarray")
        shape, step, coordinates = tuple(sizes.values()), len(self), {}
        for name, size in sizes.items():
            step //= size
            first_values = self._column(name).some(slice(0, size * step, step)).shown(units)
            coordinates[name] = _array(first_values)
        variables = {}
        for name in (name for name in self._columns if name not in sizes):
            values = _array(self._column(name).shown(units)).reshape(shape)
            variables[name] = (tuple(sizes), values, self._about(name, units))
        dataset = xarray.Dataset(variables, coords=coordinates, attrs={"name": self.name})
        for name in sizes:
            dataset[name].attrs.update(self._about(name, units))
        return dataset

    def _about(self, name: str, units: Units) -> dict[str, str]:
        unit = self._column(name).unit(units)
        return {"units": unit} if unit else {}

    # ---- text ----

    def __str__(self) -> str:
        """The first rows and columns in display units."""
        cells = self._cells(len(self._columns))
        count, width = 0, -2
        for column in zip(*cells, strict=True):
            width += max(map(len, column)) + 2
            if count and width > WIDTH:
                break
            count += 1
        right = [k for k, column in enumerate(self._columns.values()) if _is_number(column)]
        lines = [aligned([row[:count] for row in cells], right=[k for k in right if k < count])]
        return "\n".join([*lines, *self._left_out(count)])

    def _repr_html_(self) -> str:
        """The first rows and columns in display units, as HTML for notebooks."""
        from .html import pieces

        head, *rows = self._cells(COLUMNS)
        columns = [
            PageColumn(title, "right" if _is_number(column) else "left")
            for title, column in zip(head, self._columns.values(), strict=False)
        ]
        note = "; ".join(self._left_out(len(head)))
        return pieces([Table(self.name, columns, rows, note=note)])

    def _cells(self, most: int) -> list[list[str]]:
        """Heads and cells of the first rows and columns, as text in display units."""
        part, columns = slice(0, ROWS), [*self._columns.values()][:most]
        shown_columns = [
            [
                heading(column.name, column.unit("display")),
                *(map(_text, _plain(_some(column.some(part).shown("display"), slice(None))))),
            ]
            for column in columns
        ]
        return [list(row) for row in zip(*shown_columns, strict=True)]

    def _left_out(self, columns: int) -> list[str]:
        rows, columns = len(self) - ROWS, len(self._columns) - columns
        words = [f"{rows} more rows"] if rows > 0 else []
        return words + ([f"{columns} more columns"] if columns > 0 else [])


def _require(value: object, allowed: Sequence[str] | Mapping[str, object], name: str) -> None:
    if value not in tuple(allowed):
        message = f'{name} "{shown(value)}": unknown'
        raise UsageError(Diagnostic(message, remedy(str(value), allowed)))


def _kind(values: Values) -> Literal["whole", "number", "flag", "text"]:
    if isinstance(values, Coded):
        return "text"
    return "flag" if values.dtype == bool else "whole" if values.dtype.kind == "i" else "number"


def _is_number(column: DataColumn) -> bool:
    return _kind(column.values) in ("whole", "number")


def _plain(values: Values) -> list[Any]:
    """Values as Python objects; None where missing."""
    if isinstance(values, Coded):
        return list(_texts(values))
    if values.dtype.kind == "f":
        return [None if x != x else x for x in values.tolist()]
    return list(values.tolist())


def _text(value: Any) -> str:
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, float):
        return short(value, 5)
    return "" if value is None else str(value)


def _order(values: Values, descending: bool) -> Array:
    """Indices that sort values, equal ones in their order, missing ones last."""
    if isinstance(values, Coded):
        ranks = np.empty(len(values.words) + 1)
        ranks[np.argsort(np.array(values.words, dtype=str), kind="stable")] = range(
            len(values.words)
        )
        ranks[-1] = np.nan
        values = ranks[values.codes]
    numbers = values.astype(float)
    order: Array = np.argsort(-numbers if descending else numbers, kind="stable")
    return order


# ---- frames of other packages ----


def _pandas(values: Mapping[str, Values], units: dict[str, str]) -> Any:
    pandas = package("pandas")

    def series(column: Values) -> Any:
        if not isinstance(column, Coded):
            return column
        return pandas.Categorical.from_codes(column.codes, categories=list(column.words))

    data = {name: series(column) for name, column in values.items()}
    frame = pandas.DataFrame(data, copy=False)
    frame.attrs["units"] = units
    return frame


def _polars(values: Mapping[str, Values], units: dict[str, str]) -> Any:
    polars = package("polars")

    def series(name: str, column: Values) -> Any:
        if isinstance(column, Coded):
            codes = polars.Series(name, column.codes)
            codes = codes.set(codes < 0, None)
            words = polars.Series(name, list(column.words), dtype=polars.String)
            return words.gather(codes).cast(polars.Categorical)
        return polars.Series(name, column, nan_to_null=True)

    return polars.DataFrame([series(name, column) for name, column in values.items()])


def _arrow(values: Mapping[str, Values], units: dict[str, str]) -> Any:
    arrow = package("pyarrow", writes=False)

    def array(column: Values) -> Any:
        if isinstance(column, Coded):
            codes = arrow.array(column.codes.astype(np.int32), mask=column.codes < 0)
            words = arrow.array(list(column.words), arrow.string())
            return arrow.DictionaryArray.from_arrays(codes, words)
        mask = np.isnan(column) if column.dtype.kind == "f" else None
        return arrow.array(column, mask=mask)

    arrays = {name: array(column) for name, column in values.items()}
    fields = [
        arrow.field(name, each.type, metadata={"unit": units[name]} if name in units else None)
        for name, each in arrays.items()
    ]
    return arrow.table(list(arrays.values()), schema=arrow.schema(fields))


_FRAMES: dict[str, Callable[[Mapping[str, Values], dict[str, str]], Any]] = {
    "pandas": _pandas,
    "polars": _polars,
    "pyarrow": _arrow,
}
