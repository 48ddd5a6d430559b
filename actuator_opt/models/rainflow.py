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

from ..base.numeric import Array, histories, real, sorted_unique


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
    columns = numbers.reshape(len(numbers), -1)
    pairs = [_pairs(columns[:, k]) for k in range(columns.shape[1])]
    rows = max(map(len, pairs), default=0)
    index = np.zeros((2, rows, len(pairs)), dtype=np.int64)
    count = np.zeros((rows, len(pairs)))
    for k, found in enumerate(pairs):
        index[:, : len(found), k] = np.array(found, dtype=np.int64).reshape(-1, 2).T
        count[: len(found), k] = 1.0
    shape = (rows, *numbers.shape[1:])
    return Cycles(index[0].reshape(shape), index[1].reshape(shape), count.reshape(shape))


def _pairs(history: Any) -> list[tuple[int, int]]:
    """Samples of the largest and the smallest value of every cycle of a repeating history."""
    import rainflow

    unknown = np.isnan(history)
    if unknown.any():
        sample = int(np.argmax(unknown))
        return [(sample, sample)]
    # Ranks instead of values: products of small differences would underflow.
    ranks = np.searchsorted(sorted_unique(history), history)
    size, start = len(ranks), int(np.argmax(ranks))
    if ranks.min() == ranks.max():
        return []
    rotated = np.append(np.roll(ranks, -start), ranks[start]).tolist()
    closed: list[tuple[int, int]] = []
    halves: list[tuple[int, int]] = []
    for _, _, count, first, second in rainflow.extract_cycles(rotated):
        (closed if count == 1.0 else halves).append((first, second))
    # From the largest value down and up again: the halves are in pairs, the first leads down.
    samples = ((i, k) if rotated[i] > rotated[k] else (k, i) for i, k in [*closed, *halves[::2]])
    return [((i + start) % size, (k + start) % size) for i, k in samples]
