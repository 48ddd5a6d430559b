"""Rainflow counting of repeating stress histories.

A counted cycle is a pair of samples, the larger and the smaller. Counting compares values only, so
that pairs depend on the order of the values, not on their size. Amplitude and mean are then smooth
functions of the two samples; their slopes are exact for the pairs found. Where two values are equal
the pairs may change, but the damage is continuous there.

Fatigue life and damage of the cycles are in `endurance`.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from ..base.numeric import Array, histories, real
from ..base.symbolic import program as programs


class Cycles(NamedTuple):
    """Counted cycles of a history, cycles on the first axis.

    Attributes
    ----------
    largest, smallest : indices of the samples of each cycle's largest and smallest value [-]
    count : how often the cycle occurs per repeat of the history [-]; 0 fills up the columns of
        histories that have fewer cycles than others
    """

    largest: Array
    smallest: Array
    count: Array


def repeating_cycles(*, history: Array | Sequence[Array]) -> Cycles:
    """Rainflow cycles of a history that repeats.

    The history is rotated so that it begins and ends at its largest value. Every cycle then closes:
    no half cycle remains, and the cycles do not depend on where the history begins.

    Parameters
    ----------
    history : stress at the samples, time on the first axis; further axes are histories of their
        own [Pa]

    Returns
    -------
    indices and count of the cycles [-]; none for a constant history. A history with a NaN gets one
    cycle at that sample, so that its damage is NaN

    Notes
    -----
    Valid: the history repeats; a first sample repeated as the last changes nothing.

    The cycles are those of the four-point rule [McInnes2008].

    References
    ----------
    [ASTM-E1049] section 5.4.5, simplified rainflow counting for repeating histories

    Examples
    --------
    >>> cycles = repeating_cycles(history=[0.0, 210.0, 80.0, 150.0, 20.0, 120.0, 0.0])
    >>> [(int(i), int(k)) for i, k in zip(cycles.largest, cycles.smallest)]
    [(3, 2), (5, 4), (1, 0)]
    """
    (values,) = histories(history)
    numbers = np.asarray(real(values))
    columns = numbers.reshape(len(numbers), -1).T
    unknown = np.isnan(columns)
    lost = np.flatnonzero(unknown.any(axis=1))
    first = np.argmax(unknown[lost], axis=1)
    if len(lost):
        columns = columns.copy()
        columns[lost] = 0.0  # constant: without cycles
    pairs, counts = _compiled(columns) if programs.AVAILABLE else _pairs(columns.T)
    pairs[lost, 0], counts[lost] = first[:, None], 1
    most = int(counts.max(initial=0))
    used = np.arange(most)[:, None] < counts
    index = np.where(used, pairs[:, :most].transpose(2, 1, 0), 0)
    shape = (most, *numbers.shape[1:])
    largest, smallest, count = (x.reshape(shape) for x in (*index, used.astype(float)))
    return Cycles(largest, smallest, count)


class _Pairs(NamedTuple):
    """Samples of the cycles of every history (histories, cycles, 2), and their number."""

    samples: npt.NDArray[Any]
    number: npt.NDArray[Any]


def _compiled(histories: npt.NDArray[np.float64]) -> _Pairs:
    """Samples of the cycles of histories (histories, samples), as `_pairs` counts them."""
    pairs = np.empty((*histories.shape, 2), dtype=np.int32)
    counts = np.empty(len(histories), dtype=np.int32)
    programs.COMPILED.cycles(np.ascontiguousarray(histories), pairs, counts)
    return _Pairs(pairs, counts)


def _pairs(columns: npt.NDArray[np.float64]) -> _Pairs:
    """Samples of the cycles of histories (samples, histories), without the compiled machine.

    All histories are in one row, each from its largest value to its largest value. Of four
    successive reversals the inner two are a cycle if their range is not above either of its
    neighbours; they leave the row. Ranges that share a reversal compare as their other ends,
    without rounding. In the end only the least values between the largest are left.
    """
    size, count = columns.shape
    values = columns.T
    closed = np.concatenate([values[:, -1:], values, values[:, :1]], axis=1)
    up, down = closed[:, 1:] > closed[:, :-1], closed[:, 1:] < closed[:, :-1]
    straight = (up[:, 1:] & up[:, :-1]) | (down[:, 1:] & down[:, :-1])
    column, sample = np.nonzero(~straight)
    start = np.argmax(values, axis=1)
    turn = np.append((sample - start[column]) % size, np.full(count, size))
    column, sample = np.append(column, np.arange(count)), np.append(sample, start)
    order = np.argsort(column * (size + 1) + turn, kind="stable")
    column, sample = column[order], sample[order]
    values = values[column, sample]
    largest = values == columns.max(axis=0, initial=-np.inf)[column]
    row = np.arange(len(values))
    row = row[np.append((values[1:] != values[:-1]) | (column[1:] != column[:-1]), True)]
    rises = values[row[1:]] > values[row[:-1]]
    row = row[largest[row] | (np.append(rises, True) != np.append(False, rises))]
    found = []
    while True:
        level, free = values[row], ~largest[row]
        inner = free[:-1] & free[1:]
        left, right, peak = level[:-2], level[2:], level[1:-1] > level[:-2]
        inner[1:] &= np.where(peak, right >= left, right <= left)
        inner[:-1] &= np.where(peak, right <= left, right >= left)
        if not inner.any():
            break
        place = np.arange(len(inner))  # of neighbours that share a reversal, every second one
        first = np.maximum.accumulate(np.where(inner, -1, place))
        at = place[inner & ((place - first) % 2 == 1)]
        found.append(np.stack([row[at], row[at + 1]]))
        kept = np.ones(len(row), dtype=bool)
        kept[at] = kept[at + 1] = False
        row = row[kept]
    low = np.flatnonzero(~largest[row])
    ends = np.concatenate([*found, np.stack([row[low - 1], row[low]])], axis=1)
    ends = np.where(values[ends[0]] > values[ends[1]], ends, ends[::-1])
    order = np.argsort(column[ends[0]], kind="stable")
    owner, found_pairs = column[ends[0]][order], sample[ends[:, order]].T
    counts = np.bincount(owner, minlength=count)
    row = np.arange(len(owner)) - np.repeat(np.cumsum(counts) - counts, counts)
    pairs = np.zeros((count, max(int(counts.max(initial=0)), 1), 2), dtype=np.intp)
    pairs[owner, row] = found_pairs
    return _Pairs(pairs, counts)
