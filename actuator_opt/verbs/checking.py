"""Faults of a file, whatever kind of file it is."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from ..design import is_scenario
from ..design.reader import TEXT, opened
from ..errors import Diagnostic, InputError
from .actuator import Plugins, place, read, unanswered
from .simulations import read_scenario


def check(
    source: str | Path,
    *,
    set: Mapping[str, str | float] | Sequence[tuple[str, str]] = (),
    plugins: Plugins = (),
) -> list[Diagnostic]:
    """All faults of a design or scenario file; an empty list for a good one. Parameters as `read`.

    Found too: variables that no model reads, requirements that no model answers.
    """
    if source == "-":  # read once, whatever it turns out to be
        text, name = opened(source)
        found = check(f"{text}\n", set=set, plugins=plugins)
        return [replace(fault, file=name) if fault.file == TEXT else fault for fault in found]
    try:
        if is_scenario(source):
            read_scenario(source, set=set)
            return []
        actuator = read(source, set=set, plugins=plugins)
        subject = actuator.subject()
        faults = unanswered(actuator, subject)
        if faults:
            return faults
        if actuator.design.choices:
            from ..optimisation.choices import possible

            possible(subject)
        elif actuator.design.variables:
            from ..optimisation.actuator import build

            build(subject, place(actuator))
    except InputError as error:
        return error.diagnostics
    return []
