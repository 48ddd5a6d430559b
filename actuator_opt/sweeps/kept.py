"""Chunks of a sweep in its database."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..base.database import Database, Rows
from ..base.numeric import Array
from .chunk import Study


class Lacking(NamedTuple):
    """Keys and point numbers of the rows that the database lacks; None where it lacks all."""

    first: int
    keys: list[bytes]
    some: Array | None
    damaged: int
    """Rows that the database holds damaged."""


def lacking(base: Database, study: Study, first: int, count: int) -> Lacking:
    """Return the keys of a chunk whose rows are missing or damaged."""
    keys = study.keys(first, count)
    missing, damaged = base.missing(keys)
    some = None if len(missing) == len(keys) else np.array(missing, dtype=np.intp)
    return Lacking(first, [keys[k] for k in missing], some, damaged)


def kept(base: Database, study: Study, first: int, count: int) -> tuple[Rows, int]:
    """Return the stored rows of a chunk, NaN where missing, and their number."""
    keys = study.keys(first, count)
    points = study.plan.points(first, count)
    numbers = np.full((len(keys), len(study.columns)), np.nan)
    numbers[:, : len(points.numbers)] = points.numbers[study.order].T
    failures, known = {}, base.known(keys)
    for k, (row, failure) in known.items():
        if failure is not None:
            failures[k] = failure
        else:
            numbers[k] = row
    return Rows(numbers, failures), len(keys) - len(known)
