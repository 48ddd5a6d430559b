"""Chunks of a sweep of which the database has some rows."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..database import Database, Rows
from ..numeric import Array
from .chunk import Chunk, Study


class Half(NamedTuple):
    """Rows of a chunk that stand, and the numbers of those that are missing."""

    first: int
    keys: list[bytes]
    rows: Rows
    missing: Array


def half(base: Database, study: Study, first: int, count: int) -> Half:
    """Rows of a chunk that the database has."""
    keys = study.keys(first, count)
    points = study.plan.points(first, count)
    numbers = np.full((len(keys), len(study.columns)), np.nan)
    numbers[:, : len(points.numbers)] = points.numbers[study.order].T
    failures, known = {}, base.known(keys)
    for k, (blob, failure) in known.items():
        if failure is not None:
            failures[k] = failure
        else:
            numbers[k] = base.numbers(blob)
    missing = np.array([k for k in range(len(keys)) if k not in known], dtype=np.intp)
    return Half(first, keys, Rows(numbers, failures), missing)


def whole(study: Study, one: Half, fresh: Chunk | None) -> Chunk:
    """A chunk of the rows that stand and of new ones."""
    rows = one.rows
    if fresh is not None:
        rows.numbers[one.missing] = fresh.rows.numbers
        added = {int(one.missing[k]): why for k, why in fresh.rows.failures.items()}
        rows = Rows(rows.numbers, rows.failures | added)
    return study.judged(one.first, rows, len(one.missing))
