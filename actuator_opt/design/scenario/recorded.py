"""Files that a scenario's signals name, and their gaps."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final, NamedTuple

import numpy as np

from ...base.numeric import Array
from ..kinds import Of
from ..structure import child_at, entries
from .model import Scenario
from .shapes import SHAPES, Records, sampled
from .signal_faults import part_lists
from .signals import SignalSegment

WIDE: Final = 1.5
"""Step that counts as a gap in an evenly sampled record, over the normal step (a choice)."""
REGULAR: Final = 0.9
"""Least share of equal steps in an evenly sampled record (a choice)."""
ROUNDED: Final = 1e-9
"""Relative tolerance of times."""


class Gap(NamedTuple):
    """An interval without samples."""

    first: float
    """Time of its first missing sample [s]."""
    last: float
    size: int
    """Number of missing samples."""


def recorded_parts(scenario: Scenario) -> Iterator[tuple[str, SignalSegment, str]]:
    """PATH, part and dimension of the values of every recorded part."""
    for loc, section in part_lists().items():
        kind = entries(section)["value"].kind
        assert isinstance(kind, Of)
        for index, part in enumerate(child_at(scenario, loc) or ()):
            if "file" in SHAPES[part.shape].needed:
                yield f"{'.'.join(loc)}[{index}].column", part, kind.quantity.dimension


def recorded_notes(scenario: Scenario, records: Records) -> Iterator[str]:
    """Times at which a recorded signal has no data: before, after and between its samples."""
    least = ROUNDED * scenario.duration
    for path, part, _ in recorded_parts(scenario):
        found = sampled(part, records)
        if found is None:
            continue
        name = f'column "{part.column}" of {part.file} ({path.removesuffix(".column")})'
        first, last = float(found[0][0]), float(found[0][-1])
        if first > least:
            yield f"{name} begins at {first:.4g} s: its first value holds until then"
        if last < scenario.duration - least:
            yield (
                f"{name} ends at {last:.4g} s, the scenario at {scenario.duration:.4g} s: its "
                "last value is kept"
            )
        time, values = records[part.file or "", part.column or ""]
        absent = [
            one
            for one in gaps(time + part.start, values)
            if first < one.first < min(last, scenario.duration) and one.last > 0
        ]
        if absent:
            yield f"{name}: {gap_words(absent)}, interpolated linearly"


def gaps(time: Array, values: Array) -> list[Gap]:
    """Intervals of a channel without samples: NaN, and missing steps of an even time base."""
    absent = np.concatenate(([False], ~np.isfinite(values), [False])).astype(np.int8)
    turns = np.flatnonzero(np.diff(absent))
    found = [
        Gap(float(time[a]), float(time[b - 1]), int(b - a))
        for a, b in zip(turns[::2], turns[1::2], strict=True)
    ]
    steps = np.diff(time)
    if steps.size > 1:
        usual = float(np.median(steps))
        if float(np.mean(np.abs(steps - usual) < 0.5 * usual)) >= REGULAR:
            found += [
                Gap(float(time[k]) + usual, float(time[k + 1]) - usual, round(steps[k] / usual) - 1)
                for k in np.flatnonzero(steps > WIDE * usual)
            ]
    return sorted(found)


def gap_words(found: list[Gap]) -> str:
    """Number of missing samples and where: the only gap, or the first and the last.

    >>> gap_words([Gap(0.2, 0.2, 1)])
    '1 sample is missing at 0.2 s'
    >>> gap_words([Gap(0.2, 0.3, 11), Gap(0.5, 0.5, 1), Gap(1.0, 2.0, 9)])
    '21 samples are missing in 3 places, first from 0.2 to 0.3 s, last from 1 to 2 s'
    """
    said = [
        f"from {one.first:.4g} to {one.last:.4g} s" if one.size > 1 else f"at {one.first:.4g} s"
        for one in (found[0], found[-1])
    ]
    count = sum(one.size for one in found)
    head = "1 sample is missing" if count == 1 else f"{count} samples are missing"
    if len(found) == 1:
        return f"{head} {said[0]}"
    return f"{head} in {len(found)} places, first {said[0]}, last {said[1]}"
