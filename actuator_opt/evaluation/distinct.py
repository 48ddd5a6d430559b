"""Distinct designs of a batch for a model, which is then evaluated only for them.

A gradient needs a copy of the design for every variable, but most variables do not affect e.g. the
wall: for it, their copies are equal. A costly model is evaluated for the distinct designs only.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import fields, is_dataclass, replace
from typing import Any

import numpy as np

from ..base.numeric import Array

FEW = 32
"""Batch size below which a model costs about as much for all designs as for a few."""


def distinct(given: Mapping[str, Any]) -> tuple[dict[str, Any], Callable[[Array], Array]]:
    """Arguments of a model for distinct designs only, and the mapping back to all designs.

    Designs are the last axis of every array, of length 1 for a shared value; their number follows
    from the arguments that are arrays.

    Parameters
    ----------
    given : arguments: arrays, numbers, words, and lists and data classes of them
    """
    count = max((np.shape(value)[-1:] for value in given.values() if _is_array(value)), default=())
    if count <= (FEW,):
        return dict(given), lambda result: result
    return _distinct(given, *count)


def _distinct(
    given: Mapping[str, Any], count: int
) -> tuple[dict[str, Any], Callable[[Array], Array]]:
    arrays = _arrays(tuple(given.values()))
    rows = [array.reshape(-1, count) for array in arrays if array.shape[-1] == count]
    if any(array.dtype.hasobject for array in rows):
        return dict(given), lambda result: result
    designs = np.ascontiguousarray(np.concatenate(rows).T)
    known: dict[bytes, int] = {}
    back = np.array([known.setdefault(one.tobytes(), len(known)) for one in designs])
    if len(known) == count:
        return dict(given), lambda result: result
    first = np.unique(back, return_index=True)[1]

    def some(array: Array) -> Array:
        return array[..., first] if array.shape[-1] == count else array

    def every(result: Array) -> Array:
        return result if np.shape(result)[-1] == 1 else result[..., back]

    return {name: _changed(value, some) for name, value in given.items()}, every


def _is_array(value: Any) -> bool:
    return isinstance(value, np.ndarray) and value.ndim > 0


def _arrays(value: Any) -> Iterator[Array]:
    """All arrays in a value."""
    if _is_array(value):
        yield value
    elif isinstance(value, (list, tuple)):
        for part in value:
            yield from _arrays(part)
    elif is_dataclass(value):
        for part in fields(value):
            yield from _arrays(getattr(value, part.name))


def _changed(value: Any, change: Callable[[Array], Array]) -> Any:
    """A value with every array in it replaced."""
    if _is_array(value):
        return change(value)
    if isinstance(value, (list, tuple)):
        return type(value)(_changed(part, change) for part in value)
    if is_dataclass(value) and not isinstance(value, type):
        own = {part.name: _changed(getattr(value, part.name), change) for part in fields(value)}
        return replace(value, **own)
    return value
