"""Faults of signals over time, and of the simulated time."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from functools import cache

from ...base import quantities
from ...base.errors import Fault
from ..build import how_to_add
from ..section import Section
from ..structure import Loc, entries
from ..view import View, without_effect
from .model import FEWEST_SAMPLES, MOST_SAMPLES, SAMPLES, Scenario
from .shapes import SHAPES
from .signals import SignalSegment

_SLACK = 1e-9
"""Relative tolerance of times."""
_time = quantities.SCENARIOS["instant"].text
_short = quantities.SCENARIOS["sample_time"].text
_hertz = quantities.INPUTS["frequency"].text


@cache
def part_lists(
    section: type[Section] = Scenario, loc: tuple[str, ...] = ()
) -> Mapping[tuple[str, ...], type[Section]]:
    """Places of the signals in a scenario, with the section type of their parts.

    >>> [".".join(loc) for loc in part_lists()][:3]
    ['motor.torque', 'load.force', 'load.torque']
    """
    found: dict[tuple[str, ...], type[Section]] = {}
    for name, entry in entries(section).items():
        if entry.section is None:
            continue
        if entry.shape == "list" and issubclass(entry.section, SignalSegment):
            found[*loc, name] = entry.section
        elif entry.shape == "section":
            found |= part_lists(entry.section, (*loc, name))
    return found


def _parts(view: View) -> Iterator[tuple[Loc, str, type[Section]]]:
    """Place, shape and section of every part with a known shape."""
    for where, section in part_lists().items():
        for index in range(len(view.items(*where))):
            shape = view.text(*where, index, "shape")
            if shape is not None and shape in SHAPES:
                yield (*where, index), shape, section


def shapes(view: View) -> Iterator[Fault]:
    """Each part has the keys that its shape needs, and no others."""
    for loc, shape, section in _parts(view):
        own, known = SHAPES[shape], entries(section)
        for key in own.needed:
            if not view.has(*loc, key):
                how = how_to_add(key, known[key])
                yield Fault((*loc, key), f"missing: required by a {shape}", how)
        for key in known:
            if key == "shape" or key in own.needed or key in own.read:
                continue
            other = own.instead.get(key)
            remedy = "remove the line" + (f', or write "shape: {other}"' if other else "")
            yield from without_effect(view, loc, [key], f"on a {shape}", remedy)


def order(view: View) -> Iterator[Fault]:
    """Each part ends after its start, and starts before the scenario ends."""
    duration = view.number("duration")
    for loc, shape, _ in _parts(view):
        start, end = view.number(*loc, "start"), view.number(*loc, "end")
        if start is None:
            continue
        reads = (*SHAPES[shape].needed, *SHAPES[shape].read)
        if end is not None and "end" in reads and end <= start:
            message = f"{_time(end)}: not after start ({_time(start)})"
            yield Fault((*loc, "end"), message, f"write more than {_time(start)}")
        if duration is not None and "start" in reads and start >= duration:
            message = f"{_time(start)}: not before the scenario ends ({_time(duration)})"
            remedy = f"write less than {_time(duration)}, or raise duration"
            yield Fault((*loc, "start"), message, remedy)


def sampling(view: View) -> Iterator[Fault]:
    """The number of samples is reasonable for the run and for each of its sines."""
    duration, stated = view.number("duration"), view.number("sample_time")
    if duration is None or (stated is None and view.has("sample_time")):
        return
    finest, coarsest = duration / MOST_SAMPLES, duration / FEWEST_SAMPLES
    sample = duration / SAMPLES if stated is None else stated
    if sample < finest * (1 - _SLACK):
        yield Fault(
            ("sample_time",),
            f"{_short(sample)}: more than {MOST_SAMPLES / 1e6:g} million samples",
            f"write at least {_short(_rounded(finest, math.ceil))}, or shorten duration",
        )
    elif sample > coarsest * (1 + _SLACK):
        yield Fault(
            ("sample_time",),
            f"{_short(sample)}: fewer than {FEWEST_SAMPLES} samples in {_time(duration)}",
            f"write at most {_short(_rounded(coarsest, math.floor))}",
        )
    else:
        yield from _sines(view, duration, sample, stated is not None)


def _sines(view: View, duration: float, sample: float, stated: bool) -> Iterator[Fault]:
    """Sines that the sample time cannot resolve; only the fastest of several."""
    waves: list[tuple[float, Loc]] = []
    for loc, shape, _ in _parts(view):
        frequency = view.number(*loc, "frequency")
        if "frequency" in SHAPES[shape].needed and frequency is not None:
            waves.append((frequency, (*loc, "frequency")))
    if not waves:
        return
    frequency, loc = max(waves, key=lambda wave: wave[0])
    needed = 1 / (FEWEST_SAMPLES * frequency)
    if sample <= needed * (1 + _SLACK):
        return
    if needed < duration / MOST_SAMPLES * (1 - _SLACK):
        message = (
            f"{_hertz(frequency)} over {_time(duration)}: "
            f"would need more than {MOST_SAMPLES / 1e6:g} million samples"
        )
        yield Fault(loc, message, "lower it, or shorten duration")
        return
    good = _short(_rounded(needed, math.floor))
    message = f"sample time too coarse: {_hertz(frequency)} needs {good} or less"
    if stated:
        yield Fault(("sample_time",), message, f"write {good}")
    else:
        yield Fault(loc, message, f'add "sample_time: {good}"')


def _rounded(value: float, way: Callable[[float], int]) -> float:
    """A time rounded up or down to three digits."""
    step = 10.0 ** (math.floor(math.log10(value)) - 2)
    return way(value / step * (1 + (_SLACK if way is math.floor else -_SLACK))) * step


CHECKS: tuple[Callable[[View], Iterator[Fault]], ...] = (shapes, order, sampling)
