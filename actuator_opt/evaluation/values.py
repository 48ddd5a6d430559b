"""Numerical values of an evaluated design: fixed values as floats, varied values as arrays.

Varied values are arrays (designs,). Values of load cases are (cases, 1) or (cases, designs), so
that all results broadcast to (cases, designs). The PATH of every value that is used is recorded,
because a variable that no model uses is a fault of the design file.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import fields, is_dataclass
from math import isfinite
from typing import Any

import numpy as np

from ..base.numeric import Array, array_of, namespace


class Values:
    """Numerical values in SI by PATH, such as `cylinder.bore`."""

    def __init__(
        self,
        numbers: Mapping[str, float],
        cases: Sequence[str],
        varied: Mapping[str, Array] | None = None,
    ) -> None:
        self._numbers = numbers
        self.varied = varied or {}
        self.cases = tuple(cases)
        self.read: set[str] = set()
        self._case_cache: dict[str, Array] = {}

    @property
    def paths(self) -> list[str]:
        """PATHs of all numbers."""
        return list(dict.fromkeys((*self._numbers, *self.varied)))

    def __contains__(self, path: str) -> bool:
        return path in self.varied or path in self._numbers

    def __getitem__(self, path: str) -> Array:
        self.read.add(path)
        array = self.varied.get(path)
        return self._numbers[path] if array is None else array

    def get(self, path: str, default: Array) -> Array:
        """The number at `path`, or `default` if the design does not state it."""
        return self[path] if path in self else default  # noqa: SIM401 (self[path] records the read)

    def case(self, field: str, default: Array = None) -> Array:
        """The value of a key in every load case, (cases, 1) or (cases, designs)."""
        if field not in self._case_cache:
            self._case_cache[field] = stacked(
                [self.get(f"load_cases[{name}].{field}", default) for name in self.cases]
            )
        return self._case_cache[field]


def stacked(rows: Sequence[Array]) -> Array:
    """Stack the values of all load cases, floats or arrays (designs,), to (cases, 1 or designs)."""
    if all(isinstance(row, float) for row in rows):
        return np.array(rows)[:, None]
    if len(rows) == 1 and not isinstance(rows[0], np.ndarray) and namespace(rows[0]) is not np:
        # a single symbol is a scalar
        return rows[0]
    return np.stack(np.broadcast_arrays(*[np.atleast_1d(array_of(row)) for row in rows]))


def of_case(value: Array, index: int) -> float:
    """The value of a load case, from a float or an array (cases, 1) or (1, 1)."""
    array = np.atleast_2d(np.asarray(value))
    return float(array[min(index, array.shape[0] - 1), 0])


def plain(value: Any) -> Any:
    """Convert data classes, arrays and sequences to JSON data; NaN and infinity become None."""
    if is_dataclass(value):
        return {field.name: plain(getattr(value, field.name)) for field in fields(value)}
    if isinstance(value, Mapping):
        return {key: plain(entry) for key, entry in value.items()}
    if isinstance(value, np.ndarray):
        return plain(value.tolist())
    if isinstance(value, (list, tuple)):
        return [plain(entry) for entry in value]
    return None if isinstance(value, float) and not isfinite(value) else value
