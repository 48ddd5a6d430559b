"""The columns of a sweep's rows as files have them, whatever their format.

A design's number, what varies, its metrics, the least margin, then the limit it is of, whether all
are met, and why a design failed. Values stand in the unit people read, which the names tell.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..base.numeric import Array
from ..base.quantities import Quantity
from ..design.paths import quantity_of
from ..rendering.series import heading
from ..sweeps.chunk import Chunk, Study

NUMBER, LIMIT, MET, FAILURE = "number", "governing_limit", "feasible", "failure"
"""Columns beside those of numbers and of texts that vary."""


class Figure(NamedTuple):
    """A column of numbers."""

    name: str
    label: str
    quantity: Quantity | None = None

    @property
    def unit(self) -> str:
        """The unit it stands in; "" where it has none."""
        return "" if self.quantity is None else self.quantity.unit

    @property
    def head(self) -> str:
        """The name with its unit."""
        return heading(self.name, self.unit)


class SweepColumns:
    """Columns of a study: `named` are PATHs of texts, `figures` are numbers."""

    def __init__(self, study: Study) -> None:
        self.study = study
        self.named = [axis.path for axis in study.plan.named]
        count = len(study.plan.numeric)
        varied = [column.name for column in study.columns[:count]]
        margin = study.columns[-3].name
        self.figures = [
            *(Figure(path, path, quantity_of(path, study.design)) for path in varied),
            *(
                Figure(name, study.quantity(name).label, study.quantity(name))
                for name in study.metrics
            ),
            Figure(margin, "least margin of all limits, a share of the limit"),
        ]
        self.heads = [NUMBER, *self.named, *(one.head for one in self.figures), LIMIT, MET, FAILURE]

    def shown(self, chunk: Chunk) -> Array:
        """The numbers (rows, figures) of a chunk; NaN where there is none."""
        found = chunk.rows.numbers[:, : len(self.figures)].copy()
        for k, one in enumerate(self.figures):
            if one.quantity is not None:
                found[:, k] = one.quantity.to_display(found[:, k])
        return found

    def variants(self, chunk: Chunk) -> Array:
        """The number of the texts that each row has."""
        count = len(chunk.rows.numbers)
        if not self.named:
            return np.zeros(count, dtype=np.int64)
        return self.study.plan.points(chunk.first, count).variant
